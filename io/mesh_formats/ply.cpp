#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/ply_header.hpp"
#include "io/mesh_formats/polygon.hpp"
#include "io/text_scanner.hpp"

// PLY: G. Turk, "The PLY Polygon File Format", Stanford 1994. Elements and properties that mean nothing here are
// skipped by their declared sizes.
namespace tri::io_detail {
namespace {

// Values of the body as doubles, which hold every type of PLY exactly.
class AsciiSource {
 public:
  AsciiSource(std::string_view bytes, std::size_t offset, const std::string& file) : scanner_(bytes, file) {
    scanner_.move_to(bytes.data() + offset);
  }
  std::size_t offset() const { return scanner_.offset(); }
  std::size_t remaining() const { return scanner_.remaining(); }
  static std::size_t least_size(const PlyProperty&) { return 2; }  // a digit and what ends it
  std::size_t slack() const { return 1; }                          // the last line may lack its end

  void begin_record(const PlyElement& element, std::uint64_t i) {
    if (!scanner_.next_filled_line(0))
      scanner_.fail(fmt::format("truncated: {} of {} {} elements", i, element.count, element.name));
    value_at_ = scanner_.position();
  }
  void end_record() {
    if (!scanner_.at_line_end()) ++lines_with_more_;
    scanner_.next_line();
  }
  double value(PlyType, const std::string& name) {
    scanner_.skip_blanks();
    value_at_ = scanner_.position();
    return scanner_.number(name.c_str());
  }
  void skip(PlyType type, std::uint64_t count, const std::string& name) {
    for (std::uint64_t k = 0; k < count; ++k) value(type, name);
  }
  void finish(MeshFileInfo& info) {
    if (lines_with_more_ > 0)
      info.notes.push_back(
          fmt::format("{} lines hold more values than their element declares; they were left out", lines_with_more_));
    if (scanner_.next_filled_line(0))
      info.notes.push_back(
          fmt::format("what follows the last element was left out, from {}", quoted(scanner_.rest_of_line())));
  }
  /// About the value read last.
  [[noreturn]] void fail(const std::string& message) const { scanner_.fail(message, value_at_); }

 private:
  TextScanner scanner_;
  const char* value_at_ = nullptr;
  std::uint64_t lines_with_more_ = 0;
};

template <bool swap_bytes>
class BinarySource {
 public:
  BinarySource(std::string_view bytes, std::size_t offset, const std::string& file)
      : bytes_(bytes), file_(file), at_(offset) {}
  std::size_t offset() const { return at_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  static std::size_t least_size(const PlyProperty& property) {
    return size_of(property.is_list ? property.count_type : property.type);
  }
  std::size_t slack() const { return 0; }

  void begin_record(const PlyElement&, std::uint64_t) {}
  void end_record() {}
  double value(PlyType type, const std::string& name) {
    value_at_ = at_;
    switch (type) {
      case PlyType::i8:
        return take<std::int8_t>(name);
      case PlyType::u8:
        return take<std::uint8_t>(name);
      case PlyType::i16:
        return take<std::int16_t>(name);
      case PlyType::u16:
        return take<std::uint16_t>(name);
      case PlyType::i32:
        return take<std::int32_t>(name);
      case PlyType::u32:
        return take<std::uint32_t>(name);
      case PlyType::f32:
        return static_cast<double>(take<float>(name));
      case PlyType::f64:
        break;
    }
    return take<double>(name);
  }
  void skip(PlyType type, std::uint64_t count, const std::string& name) {
    value_at_ = at_;
    if (count > remaining() / size_of(type)) truncated(name);
    at_ += count * size_of(type);
  }
  void finish(MeshFileInfo& info) const {
    if (remaining() > 0)
      info.notes.push_back(fmt::format("{} bytes after the last element were left out", remaining()));
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw IoError(file_, message, IoError::Unit::byte, value_at_);
  }

 private:
  template <class Value>
  Value take(const std::string& name) {
    if (remaining() < sizeof(Value)) truncated(name);
    std::array<char, sizeof(Value)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(Value));
    at_ += sizeof(Value);
    if constexpr (swap_bytes) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Value>(raw);
  }
  [[noreturn]] void truncated(const std::string& name) const {
    fail("truncated: the file ends where " + name + " should be");
  }

  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_;
  std::size_t value_at_ = 0;
};

template <class Source>
class PlyParser {
 public:
  PlyParser(Source source, const PlyHeader& header, const std::string& file, std::size_t size, MeshFileInfo& info)
      : source_(std::move(source)), header_(header), file_(file), size_(size), info_(info) {}

  Soup run(Context& context) {
    check_counts();
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        vertices(element, context);
      else if (element.name == "face" || element.name == "polygon")
        faces(element, context);
      else if (element.name == "tristrips")
        strips(element, context);
      else
        others(element, context);
    }
    source_.finish(info_);
    if (odd_textures_ > 0)
      info_.notes.push_back(
          fmt::format("the lists texcoord of {} faces are not kept: not two values for each corner", odd_textures_));
    info_.parts.emplace_back();
    collector_.finish(soup_, info_, context);
    // Faces may come from several elements (strips beside faces), of which one need not have what another has.
    std::erase_if(soup_.face_scalars, [this](const auto& scalar) {
      if (scalar.second.size() == soup_.triangles.size()) return false;
      info_.notes.push_back(fmt::format("the face scalar {} is not kept: not all faces have it", scalar.first));
      return true;
    });
    return std::move(soup_);
  }

 private:
  void check_counts() {
    bool has_vertices = false;
    double least = 0;  // a double, so that absurd counts cannot overflow
    for (const PlyElement& element : header_.elements) {
      for (const PlyProperty& property : element.properties)
        least += static_cast<double>(element.count) * static_cast<double>(Source::least_size(property));
      if (element.name != "vertex") continue;
      has_vertices = true;
      vertex_count_ = element.count;
    }
    if (!has_vertices) fail_header("a PLY file without an element vertex");
    if (vertex_count_ > 0xFFFFFFFE) fail_header(fmt::format("{} vertices are too many", vertex_count_));
    if (least > static_cast<double>(source_.remaining() + source_.slack()))
      throw IoError(
          file_,
          fmt::format("truncated or absurd: the elements of the header need at least {:.0f} bytes, {} are left", least,
                      source_.remaining()),
          IoError::Unit::byte, source_.offset());
  }

  // About what the header does not say: at its last line.
  [[noreturn]] void fail_header(const std::string& message) const {
    throw IoError(file_, message, IoError::Unit::line, header_.lines);
  }

  void report(Context& context, std::uint64_t i) const {
    if (i % (checkpoint_interval / 4) != 0) return;
    context.checkpoint();
    context.progress("read", static_cast<double>(source_.offset()) / static_cast<double>(size_));
  }

  std::uint64_t list_size(const PlyProperty& property) {
    const double count = source_.value(property.count_type, property.name);
    if (!(count >= 0 && count == std::floor(count) && count <= static_cast<double>(source_.remaining())))
      source_.fail(
          fmt::format("a list {} of {} entries, {} bytes are left", property.name, count, source_.remaining()));
    return static_cast<std::uint64_t>(count);
  }

  void skip(const PlyProperty& property) {
    const std::uint64_t count = property.is_list ? list_size(property) : 1;
    source_.skip(property.type, count, property.name);
  }

  void others(const PlyElement& element, Context& context) {
    if (element.count > 0 && !element.properties.empty())
      info_.notes.push_back(fmt::format("{} elements {} are not kept", element.count, element.name));
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      report(context, i);
      source_.begin_record(element, i);
      for (const PlyProperty& property : element.properties) skip(property);
      source_.end_record();
    }
  }

  void note_list(const PlyElement& element, const PlyProperty& property) {
    info_.notes.push_back(fmt::format("the lists {} of the {} elements are not kept", property.name, element.name));
  }

  void vertices(const PlyElement& element, Context& context) {
    const std::size_t n = element.count;
    const auto has = [&element](std::string_view name) {
      const PlyProperty* property = element.find(name);
      return property && !property->is_list;
    };
    for (const char* name : {"x", "y", "z"})
      if (!has(name)) fail_header(fmt::format("the element vertex has no property {}", name));
    const bool normals = has("nx") && has("ny") && has("nz");
    std::array<const char*, 3> color_names{"red", "green", "blue"};
    if (!has("red") && has("diffuse_red")) color_names = {"diffuse_red", "diffuse_green", "diffuse_blue"};
    bool colors = true;
    for (const char* name : color_names) colors = colors && has(name) && element.find(name)->type == PlyType::u8;

    // Where each property goes: 0-2 position, 3-5 normal, 6-8 colour, 9 further scalar, 10 nowhere.
    std::vector<int> role;
    std::vector<double*> column;
    for (const PlyProperty& property : element.properties) {
      int r = 9;
      if (property.is_list) r = 10;
      for (int k = 0; k < 3 && !property.is_list; ++k) {
        if (property.name == std::string(1, static_cast<char>('x' + k))) r = k;
        if (normals && property.name == std::string("n") + static_cast<char>('x' + k)) r = 3 + k;
        if (colors && property.name == color_names[static_cast<std::size_t>(k)]) r = 6 + k;
      }
      role.push_back(r);
      column.push_back(nullptr);
      if (r == 9) {
        auto& values = soup_.vertex_scalars[property.name];
        values.resize(n);
        column.back() = values.data();
      }
      if (r == 10) note_list(element, property);
    }
    soup_.points.resize(n);
    if (normals) soup_.vertex_normals.resize(n);
    if (colors) soup_.vertex_colors.resize(n);

    for (std::size_t i = 0; i < n; ++i) {
      report(context, i);
      source_.begin_record(element, i);
      for (std::size_t k = 0; k < role.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        const int r = role[k];
        if (r == 10) {
          skip(property);
          continue;
        }
        const double value = source_.value(property.type, property.name);
        if (r < 3) {
          if (!std::isfinite(value)) source_.fail(fmt::format("{} of vertex {} is not finite", property.name, i));
          soup_.points[i][static_cast<std::size_t>(r)] = value;
        } else if (r < 6) {
          soup_.vertex_normals[i][static_cast<std::size_t>(r - 3)] = value;
        } else if (r < 9) {
          if (!(value >= 0 && value <= 255 && value == std::floor(value)))
            source_.fail(fmt::format("{} of vertex {}: {} is no colour value", property.name, i, value));
          soup_.vertex_colors[i][static_cast<std::size_t>(r - 6)] = static_cast<std::uint8_t>(value);
        } else {
          column[k][i] = value;
        }
      }
      source_.end_record();
    }
  }

  std::uint32_t vertex_index(double value) {
    if (!(value >= 0 && value < static_cast<double>(vertex_count_) && value == std::floor(value)))
      source_.fail(
          fmt::format("vertex index {} is not within 0 to {}", value, static_cast<std::int64_t>(vertex_count_) - 1));
    return static_cast<std::uint32_t>(value);
  }

  void faces(const PlyElement& element, Context& context) {
    const PlyProperty* indices = element.find("vertex_indices");
    if (!indices) indices = element.find("vertex_index");
    if (!indices || !indices->is_list)
      fail_header(fmt::format("the element {} has no list vertex_indices", element.name));
    std::vector<std::vector<double>*> column;
    for (const PlyProperty& property : element.properties) {
      column.push_back(property.is_list ? nullptr : &soup_.face_scalars[property.name]);
      if (property.is_list && &property != indices && property.name != "texcoord") note_list(element, property);
    }
    std::vector<double> texture;
    if (const PlyProperty* list = element.find("texcoord"); list && list->is_list)
      collector_.name_corner_columns({"s", "t"});
    std::vector<std::uint32_t> corners;
    std::vector<double> values(column.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
      report(context, i);
      source_.begin_record(element, i);
      for (std::size_t k = 0; k < column.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        if (&property == indices) {
          const std::uint64_t size = list_size(property);
          corners.clear();
          for (std::uint64_t c = 0; c < size; ++c)
            corners.push_back(vertex_index(source_.value(property.type, property.name)));
        } else if (property.is_list && property.name == "texcoord") {
          const std::uint64_t size = list_size(property);
          texture.clear();
          for (std::uint64_t c = 0; c < size; ++c) texture.push_back(source_.value(property.type, property.name));
        } else if (property.is_list) {
          skip(property);
        } else {
          values[k] = source_.value(property.type, property.name);
        }
      }
      source_.end_record();
      const bool fits = texture.size() == 2 * corners.size();
      odd_textures_ += !fits && !texture.empty();
      const std::size_t triangles = fits ? collector_.add(corners, texture, 2) : collector_.add(corners);
      texture.clear();
      for (std::size_t k = 0; k < column.size(); ++k)
        if (column[k]) column[k]->insert(column[k]->end(), triangles, values[k]);
    }
  }

  // A strip of corners a b c d … stands for the triangles abc, cbd, cde …; -1 begins a new one.
  void strips(const PlyElement& element, Context& context) {
    const PlyProperty* indices = element.find("vertex_indices");
    if (!indices) indices = element.find("vertex_index");
    if (!indices || !indices->is_list) fail_header("the element tristrips has no list vertex_indices");
    std::vector<std::uint32_t> strip;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      report(context, i);
      source_.begin_record(element, i);
      for (const PlyProperty& property : element.properties) {
        if (&property != indices) {
          skip(property);
          continue;
        }
        const std::uint64_t size = list_size(property);
        strip.clear();
        for (std::uint64_t c = 0; c < size; ++c) {
          const double value = source_.value(property.type, property.name);
          if (value == -1) {
            strip.clear();
            continue;
          }
          strip.push_back(vertex_index(value));
          const std::size_t n = strip.size();
          if (n < 3) continue;
          const bool odd = n % 2 == 0;
          const std::array<std::uint32_t, 3> triangle{strip[odd ? n - 2 : n - 3], strip[odd ? n - 3 : n - 2],
                                                      strip[n - 1]};
          collector_.add(triangle);
        }
      }
      source_.end_record();
    }
  }

  Source source_;
  const PlyHeader& header_;
  const std::string& file_;
  std::size_t size_;
  MeshFileInfo& info_;
  std::uint64_t vertex_count_ = 0;
  std::uint64_t odd_textures_ = 0;
  Soup soup_;
  PolygonCollector collector_;
};

}  // namespace

Soup parse_ply(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info) {
  info.format = MeshFormat::ply;
  const PlyHeader header = parse_ply_header(bytes, file);
  info.encoding = header.encoding;
  info.notes = header.notes;
  const auto run = [&](auto source) {
    return PlyParser<decltype(source)>(std::move(source), header, file, bytes.size(), info).run(context);
  };
  static_assert(std::endian::native == std::endian::little, "big endian files are the ones whose bytes are swapped");
  switch (header.encoding) {
    case MeshEncoding::ascii:
      return run(AsciiSource(bytes, header.size, file));
    case MeshEncoding::binary_little_endian:
      return run(BinarySource<false>(bytes, header.size, file));
    default:
      break;
  }
  return run(BinarySource<true>(bytes, header.size, file));
}

}  // namespace tri::io_detail
