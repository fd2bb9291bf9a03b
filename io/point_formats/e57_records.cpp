#include "io/point_formats/e57_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace tri::io_detail {
namespace {

constexpr std::size_t section_header_size = 32;
constexpr std::size_t smallest_packet = 4;

template <class Value>
Value record_value(const char* bytes) {
  Value value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

/// `bits` (1 to 64) bits from bit `first` on, the lowest first; eight bytes behind the last must be readable.
std::uint64_t bits_at(const char* bytes, std::uint64_t first, unsigned bits) {
  const char* p = bytes + first / 8;
  const unsigned shift = static_cast<unsigned>(first % 8);
  std::uint64_t value = record_value<std::uint64_t>(p) >> shift;
  if (shift + bits > 64) value |= std::uint64_t{static_cast<unsigned char>(p[8])} << (64 - shift);
  return bits == 64 ? value : value & ((std::uint64_t{1} << bits) - 1);
}

}  // namespace

E57Records::E57Records(E57Pages& pages, const E57Scan& scan, std::vector<bool> wanted)
    : pages_(pages), scan_(scan), columns_(scan.fields.size()) {
  double least_bits = 0;  // a double, so that absurd counts cannot overflow
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const E57Field& field = scan.fields[k];
    columns_[k].bits = field.bits();
    columns_[k].wanted = wanted[k];
    columns_[k].constant = static_cast<double>(field.minimum) * field.scale + field.offset;
    least_bits += columns_[k].bits * static_cast<double>(scan.records);
  }
  if (scan.records == 0) return;
  char header[section_header_size];
  pages.read(scan.section, sizeof header, header, "the header of the points' section");
  if (header[0] != 1) pages.fail(fmt::format("no section of points, but of the kind {}", int(header[0])), scan.section);
  const auto length = record_value<std::uint64_t>(header + 8);
  at_ = record_value<std::uint64_t>(header + 16);
  if (length < section_header_size || length > pages.remaining(scan.section))
    pages.fail(fmt::format("truncated or absurd: the points' section is of {} bytes, {} are left", length,
                           pages.remaining(scan.section)),
               scan.section);
  const std::uint64_t behind = pages.remaining(scan.section) - length;  // bytes of the file after the section
  if (at_ < scan.section || pages.remaining(at_) <= behind)
    pages.fail(fmt::format("the points' data at byte {} is not within their section", at_), scan.section);
  left_ = pages.remaining(at_) - behind;
  if (!(least_bits > 0)) pages.fail("the records hold no bits: every point is the same", scan.section);
  if (least_bits > 8.0 * static_cast<double>(left_))
    pages.fail(fmt::format("truncated or absurd: {} records need {:.0f} bytes, the section has {}", scan.records,
                           least_bits / 8, left_),
               scan.section);
}

bool E57Records::next() {
  for (Column& column : columns_) {
    if (column.bits == 0 || !column.wanted) continue;
    column.taken += available_;
    // Seldom, so that moving what is left costs next to nothing.
    if (column.taken > 1 << 16 || column.taken == column.values.size()) {
      column.values.erase(column.values.begin(), column.values.begin() + static_cast<std::ptrdiff_t>(column.taken));
      column.taken = 0;
    }
  }
  first_ += available_;
  available_ = 0;
  if (first_ >= scan_.records) return false;
  while (true) {
    std::uint64_t complete = scan_.records;
    for (const Column& column : columns_)
      if (column.wanted && column.bits > 0) complete = std::min(complete, column.decoded);
    available_ = static_cast<std::size_t>(complete - first_);
    if (available_ > 0) return true;
    read_packet();
  }
}

void E57Records::read_packet() {
  packet_ = at_;
  char head[smallest_packet];
  if (left_ < sizeof head)
    pages_.fail(fmt::format("truncated: the points' section ends after {} of {} records", first_, scan_.records), at_);
  pages_.read(at_, sizeof head, head, "a packet");
  const std::size_t size = std::size_t{record_value<std::uint16_t>(head + 2)} + 1;
  if (size % 4 != 0 || size > left_) pages_.fail(fmt::format("a packet of {} bytes, {} are left", size, left_), at_);
  if (head[0] == 1) {
    buffer_.resize(size);
    pages_.read(at_, size, buffer_.data(), "a packet");
    if (size < 6) pages_.fail("a packet is smaller than its header", at_);
    const std::size_t streams = record_value<std::uint16_t>(buffer_.data() + 4);
    if (streams != columns_.size())
      pages_.fail(fmt::format("a packet of {} bytestreams for {} fields", streams, columns_.size()), at_);
    std::size_t data = 6 + 2 * streams;
    for (std::size_t k = 0; k < streams; ++k) {
      const std::size_t stream = data > size ? 0 : record_value<std::uint16_t>(buffer_.data() + 6 + 2 * k);
      if (data > size || stream > size - data) pages_.fail("a packet is smaller than its bytestreams", at_);
      if (columns_[k].wanted) decode(k, buffer_.data() + data, stream);
      data += stream;
    }
  } else if (head[0] != 0 && head[0] != 2) {  // an index or an empty packet holds nothing for us
    pages_.fail(fmt::format("a packet of the unknown kind {}", int(head[0])), at_);
  }
  at_ = pages_.advanced(at_, size);
  left_ -= size;
}

void E57Records::decode(std::size_t index, const char* bytes, std::size_t size) {
  Column& column = columns_[index];
  const E57Field& field = scan_.fields[index];
  if (column.bits == 0) return;
  column.carry.append(bytes, size);
  const std::uint64_t bits = std::uint64_t{column.carry.size()} * 8;
  column.carry.append(8, '\0');  // so that eight bytes can be read everywhere
  const char* from = column.carry.data();
  const std::uint64_t count = std::min((bits - column.carry_bit) / column.bits, scan_.records - column.decoded);
  const std::size_t before = column.values.size();
  column.values.resize(before + count);
  double* to = column.values.data() + before;
  const auto origin = static_cast<std::uint64_t>(field.minimum);
  std::uint64_t bit = column.carry_bit;
  for (std::uint64_t i = 0; i < count; ++i, bit += column.bits) {
    const std::uint64_t raw = bits_at(from, bit, column.bits);
    switch (field.kind) {
      case E57Field::Kind::single_real:
        to[i] = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
        break;
      case E57Field::Kind::double_real:
        to[i] = std::bit_cast<double>(raw);
        break;
      case E57Field::Kind::integer:
        to[i] = static_cast<double>(static_cast<std::int64_t>(raw + origin));
        break;
      case E57Field::Kind::scaled_integer:
        to[i] = static_cast<double>(static_cast<std::int64_t>(raw + origin)) * field.scale + field.offset;
        break;
      case E57Field::Kind::text:
        break;
    }
  }
  column.decoded += count;
  column.carry.resize(static_cast<std::size_t>(bits / 8));
  const std::size_t used = column.decoded == scan_.records ? column.carry.size() : static_cast<std::size_t>(bit / 8);
  column.carry.erase(0, used);
  column.carry_bit = static_cast<unsigned>(bit % 8);
}

}  // namespace tri::io_detail
