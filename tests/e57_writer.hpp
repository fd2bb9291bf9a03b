#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

// Makes small E57 files, straight from the standard and without the reader's code: its own checksum bit by bit, its own
// bit packing, bytestreams cut at places that are no record's ends.
namespace tri::test {

inline std::uint32_t slow_crc32c(const std::string& bytes) {
  std::uint32_t c = 0xFFFFFFFF;
  for (const char byte : bytes) {
    c ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) c = (c & 1) ? (c >> 1) ^ 0x82F63B78u : c >> 1;
  }
  return ~c;
}

template <class Value>
std::string le_bytes(Value value) {
  std::string out(sizeof value, '\0');
  std::memcpy(out.data(), &value, sizeof value);
  return out;
}

struct E57TestField {
  std::string name;
  std::string attributes;            ///< all of them, as in the XML: type="Integer" minimum="-3" maximum="4"
  unsigned bits = 64;                ///< of a value in the stream; 0: nothing is written
  std::vector<std::uint64_t> raw{};  ///< one per record

  static E57TestField doubles(const std::string& name, const std::vector<double>& values) {
    E57TestField field{name, "type=\"Float\" precision=\"double\"", 64};
    for (const double v : values) field.raw.push_back(std::bit_cast<std::uint64_t>(v));
    return field;
  }
  static E57TestField floats(const std::string& name, const std::vector<float>& values) {
    E57TestField field{name, "type=\"Float\" precision=\"single\"", 32};
    for (const float v : values) field.raw.push_back(std::bit_cast<std::uint32_t>(v));
    return field;
  }
  /// Integers from `low` to `high`; the XML's type may be given a scale and an offset by `more`.
  static E57TestField integers(const std::string& name, std::int64_t low, std::int64_t high,
                               const std::vector<std::int64_t>& values, const std::string& more = "") {
    unsigned bits = 0;
    for (auto range = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low); range > 0; range >>= 1)
      ++bits;
    E57TestField field{name,
                       std::string("type=\"") + (more.empty() ? "Integer" : "ScaledInteger") + "\" minimum=\"" +
                           std::to_string(low) + "\" maximum=\"" + std::to_string(high) + "\" " + more,
                       bits};
    for (const std::int64_t v : values)
      field.raw.push_back(static_cast<std::uint64_t>(v) - static_cast<std::uint64_t>(low));
    return field;
  }

  std::string stream() const {
    std::string out;
    unsigned used = 0;  // bits of the last byte
    for (std::uint64_t value : raw)
      for (unsigned b = 0; b < bits; ++b, value >>= 1) {
        if (used == 0) out += '\0';
        if (value & 1) out.back() = static_cast<char>(out.back() | 1 << used);
        used = (used + 1) % 8;
      }
    return out;
  }
};

struct E57TestScan {
  std::vector<E57TestField> fields;
  std::string more_xml;                ///< elements beside points: a pose, limits, a name
  std::size_t bytes_per_packet = 100;  ///< about so many of each stream
  std::int64_t claimed_records = -1;   ///< in the XML, if it shall lie
};

class E57TestFile {
 public:
  explicit E57TestFile(std::size_t page_size = 1024) : page(page_size), payload(page_size - 4) {}

  void add(const E57TestScan& scan) {
    while (logical_.size() % 4 != 0) logical_ += '\0';
    const std::size_t section = logical_.size();
    std::string packets = le_bytes(std::uint8_t{2}) + '\0' + le_bytes(std::uint16_t{3});  // an empty packet
    std::vector<std::string> streams;
    bool left = true;
    for (const E57TestField& field : scan.fields) streams.push_back(field.stream());
    std::vector<std::size_t> at(streams.size(), 0);
    for (int number = 0; left; ++number) {
      left = false;
      std::string sizes, data;
      for (std::size_t k = 0; k < streams.size(); ++k) {
        // Each stream at its own pace.
        const std::size_t size = std::min(streams[k].size() - at[k], scan.bytes_per_packet + 7 * ((k + number) % 5));
        sizes += le_bytes(static_cast<std::uint16_t>(size));
        data += streams[k].substr(at[k], size);
        at[k] += size;
        left = left || at[k] < streams[k].size();
      }
      std::string packet = sizes + data;
      while ((packet.size() + 6) % 4 != 0) packet += '\0';
      packets += le_bytes(std::uint8_t{1}) + '\0' + le_bytes(static_cast<std::uint16_t>(packet.size() + 5)) +
                 le_bytes(static_cast<std::uint16_t>(streams.size())) + packet;
      if (number == 1)
        packets += le_bytes(std::uint8_t{0}) + '\0' + le_bytes(std::uint16_t{31}) + std::string(28, '\x7F');
    }
    logical_ += '\x01' + std::string(7, '\0') + le_bytes(std::uint64_t{32 + packets.size()}) +
                le_bytes(physical(section + 32)) + le_bytes(std::uint64_t{0}) + packets;
    const std::size_t records = scan.fields.empty() ? 0 : scan.fields[0].raw.size();
    scans_ += "<vectorChild type=\"Structure\">" + scan.more_xml + "<points type=\"CompressedVector\" fileOffset=\"" +
              std::to_string(physical(section)) + "\" recordCount=\"" +
              std::to_string(scan.claimed_records < 0 ? static_cast<std::int64_t>(records) : scan.claimed_records) +
              "\"><prototype type=\"Structure\">";
    for (const E57TestField& field : scan.fields) scans_ += "<" + field.name + " " + field.attributes + "/>";
    scans_ += "</prototype><codecs type=\"Vector\"/></points></vectorChild>";
  }

  std::string bytes() const {
    return bytes_with_xml(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
        "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
        "xmlns:nor=\"http://www.libe57.org/E57_EXT_surface_normals.txt\"><data3D type=\"Vector\">" +
        scans_ + "</data3D></e57Root>\n");
  }

  /// The same records behind an XML section of one's own.
  std::string bytes_with_xml(const std::string& xml) const {
    std::string logical = logical_;
    while (logical.size() % 4 != 0) logical += '\0';
    const std::uint64_t offset = physical(logical.size());
    logical += xml;
    while (logical.size() % payload != 0) logical += '\0';
    const std::string header = "ASTM-E57" + le_bytes(1u) + le_bytes(0u) +
                               le_bytes(std::uint64_t{logical.size() / payload * page}) + le_bytes(offset) +
                               le_bytes(std::uint64_t{xml.size()}) + le_bytes(std::uint64_t{page});
    logical.replace(0, header.size(), header);
    std::string out;
    for (std::size_t at = 0; at < logical.size(); at += payload) {
      const std::string content = logical.substr(at, payload);
      out += content;
      for (int k = 3; k >= 0; --k) out += static_cast<char>(slow_crc32c(content) >> 8 * k & 0xFF);
    }
    return out;
  }

  const std::size_t page, payload;

 private:
  std::uint64_t physical(std::size_t logical) const { return logical / payload * page + logical % payload; }

  std::string logical_ = std::string(48, '\0');
  std::string scans_;
};

}  // namespace tri::test
