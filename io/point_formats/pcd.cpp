#include <fmt/format.h>
#ifdef TRI_WITH_LZF
#include <lzf.h>
#endif

#include <bit>
#include <cmath>
#include <cstring>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/point_formats/points_formats.hpp"
#include "io/text_scanner.hpp"
#include "meshops/points/point_soup.hpp"

// PCD 0.7: "The PCD (Point Cloud Data) file format", documentation of the Point Cloud Library.
namespace tri::io_detail {
namespace {

static_assert(std::endian::native == std::endian::little, "binary PCD is little endian");

struct Field {
  std::string name;
  std::size_t size = 4;
  char type = 'F';
  std::uint64_t count = 1;
  std::size_t offset = 0;       // bytes from the start of a point
  std::size_t first_value = 0;  // values from the start of a line
};

struct PcdHeader {
  std::vector<Field> fields;
  std::uint64_t points = 0;
  std::string data;
  std::size_t size = 0;        // bytes up to the first of the body
  std::size_t point_size = 0;  // bytes of a binary point
  std::size_t values = 0;      // of a line
  std::string viewpoint;
};

constexpr std::size_t max_fields = 1000;

class HeaderParser {
 public:
  HeaderParser(std::string_view bytes, const std::string& file) : scanner_(bytes, file) {}

  PcdHeader run() {
    PcdHeader header;
    std::uint64_t width = 0, height = 1;
    bool has_points = false, has_width = false;
    while (header.data.empty()) {
      if (!scanner_.next_filled_line('#')) scanner_.fail("truncated: the file ends within the PCD header");
      const char* first = scanner_.position();
      const std::string_view keyword = scanner_.token();
      if (keyword == "VERSION") {
        scanner_.rest_of_line();
      } else if (keyword == "FIELDS" || keyword == "COLUMNS") {
        while (!scanner_.at_line_end()) {
          header.fields.emplace_back().name = scanner_.token();
          if (header.fields.size() > max_fields) scanner_.fail("more than 1000 fields");
        }
      } else if (keyword == "SIZE") {
        for (Field& field : header.fields) field.size = count("the size of a field", 8);
      } else if (keyword == "TYPE") {
        for (Field& field : header.fields) {
          const std::string_view type = scanner_.token();
          if (type != "F" && type != "I" && type != "U")
            scanner_.fail(io_detail::quoted(type) + " is not a type of PCD");
          field.type = type[0];
        }
      } else if (keyword == "COUNT") {
        for (Field& field : header.fields) field.count = count("the count of a field", 1 << 20);
      } else if (keyword == "WIDTH") {
        width = count("the width", max_points);
        has_width = true;
      } else if (keyword == "HEIGHT") {
        height = count("the height", max_points);
      } else if (keyword == "VIEWPOINT") {
        scanner_.skip_blanks();
        header.viewpoint = scanner_.rest_of_line();
      } else if (keyword == "POINTS") {
        header.points = count("the number of points", max_points);
        has_points = true;
      } else if (keyword == "DATA") {
        header.data = scanner_.token();
        if (header.data != "ascii" && header.data != "binary" && header.data != "binary_compressed")
          scanner_.fail("unknown PCD data " + io_detail::quoted(header.data), first);
      } else {
        scanner_.fail("unknown keyword " + io_detail::quoted(keyword) + " in the PCD header", first);
      }
      if (!scanner_.at_line_end())
        scanner_.fail(io_detail::quoted(scanner_.token()) + " where the line should end", first);
      scanner_.next_line();
    }
    if (has_points && has_width && width * height != header.points)
      scanner_.fail(fmt::format("{} points, but a width of {} and a height of {}", header.points, width, height));
    if (!has_points) header.points = width * height;
    for (Field& field : header.fields) {
      const bool valid = field.type == 'F' ? field.size == 4 || field.size == 8
                                           : field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8;
      if (!valid) scanner_.fail(fmt::format("field {}: no type {} has {} bytes", field.name, field.type, field.size));
      field.offset = header.point_size;
      field.first_value = header.values;
      header.point_size += field.size * field.count;
      header.values += field.count;
    }
    header.size = scanner_.offset();
    return header;
  }

 private:
  static constexpr std::int64_t max_points = 0xFFFFFFFE;

  std::uint64_t count(const char* what, std::int64_t most) {
    const std::int64_t value = scanner_.integer(what);
    if (value < 0 || value > most) scanner_.fail(fmt::format("{} is {}", what, value));
    return static_cast<std::uint64_t>(value);
  }

  TextScanner scanner_;
};

double field_value(const char* p, const Field& field) {
  const auto as = [p](auto value) {
    std::memcpy(&value, p, sizeof value);
    return static_cast<double>(value);
  };
  if (field.type == 'F') return field.size == 4 ? as(float{}) : as(double{});
  if (field.type == 'I') {
    if (field.size == 1) return as(std::int8_t{});
    if (field.size == 2) return as(std::int16_t{});
    return field.size == 4 ? as(std::int32_t{}) : as(std::int64_t{});
  }
  if (field.size == 1) return as(std::uint8_t{});
  if (field.size == 2) return as(std::uint16_t{});
  return field.size == 4 ? as(std::uint32_t{}) : as(std::uint64_t{});
}

class PcdParser {
 public:
  PcdParser(std::string_view bytes, const std::string& file, PointsFileInfo& info)
      : bytes_(bytes), file_(file), info_(info), header_(HeaderParser(bytes, file).run()) {}

  PointSet run(Context& context) {
    choose_fields();
    const std::string_view body = bytes_.substr(header_.size);
    if (header_.data == "ascii") {
      read_ascii(context);
    } else if (header_.data == "binary") {
      const std::uint64_t wanted = header_.points * header_.point_size;
      if (body.size() < wanted) truncated(wanted, body.size());
      if (body.size() > wanted)
        info_.notes.push_back(fmt::format("{} bytes after the last point were left out", body.size() - wanted));
      reserve();
      std::vector<double> v(used_.size());
      for (std::uint64_t i = 0; i < header_.points; ++i) {
        report(context, i);
        const std::size_t at = header_.size + i * header_.point_size;
        for (std::size_t k = 0; k < used_.size(); ++k) v[k] = binary_value(bytes_.data() + at + used_[k]->offset, k);
        add(v, i, IoError::Unit::byte, at);
      }
    } else {
      read_compressed(body, context);
    }
    if (info_.points_skipped > 0)
      info_.notes.push_back(fmt::format("{} points without a measurement (NaN) were skipped", info_.points_skipped));
    if (unknown_normals_ > 0)
      info_.notes.push_back(fmt::format("{} points have no normal (NaN): it is given as 0 0 0", unknown_normals_));
    if (!header_.viewpoint.empty() && !is_identity(header_.viewpoint))
      info_.notes.push_back("the viewpoint " + io_detail::quoted(header_.viewpoint) + " was not applied");
    return std::move(set_);
  }

 private:
  [[noreturn]] void truncated(std::uint64_t wanted, std::uint64_t found) const {
    throw IoError(
        file_, fmt::format("truncated or absurd: {} points need {} bytes, {} are left", header_.points, wanted, found),
        IoError::Unit::byte, bytes_.size());
  }

  static bool is_identity(const std::string& viewpoint) {
    const std::string file;
    TextScanner scanner(viewpoint, file);
    for (int i = 0; i < 7; ++i) {
      double value = 0;
      if (!parse_number(scanner.token(), value) || value != (i == 3 ? 1 : 0)) return false;
    }
    return true;
  }

  void choose_fields() {
    const auto find = [this](const std::string& name) -> const Field* {
      for (const Field& field : header_.fields)
        if (field.name == name && field.count == 1) return &field;
      return nullptr;
    };
    for (const char* name : {"x", "y", "z"}) {
      const Field* field = find(name);
      if (!field)
        throw IoError(file_, fmt::format("the PCD header has no field {}", name), IoError::Unit::byte, header_.size);
      used_.push_back(field);
    }
    const std::array<const Field*, 3> normal{find("normal_x"), find("normal_y"), find("normal_z")};
    normals_ = normal[0] && normal[1] && normal[2];
    if (normals_) used_.insert(used_.end(), normal.begin(), normal.end());
    for (const char* name : {"rgb", "rgba"}) {
      const Field* field = find(name);
      if (packed_color_ != 0 || !field || field->size != 4) continue;
      packed_color_ = used_.size();
      packed_as_float_ = field->type == 'F';
      used_.push_back(field);
    }
    std::string ignored;
    bool has_intensity = false;
    for (const Field& field : header_.fields) {
      if (std::find(used_.begin(), used_.end(), &field) != used_.end()) continue;
      if (field.count != 1 || field.name == "_" || find(field.name) != &field) {
        if (!ignored.empty()) ignored += ", ";
        ignored += field.name;
        continue;
      }
      used_.push_back(&field);
      const bool intensity = !has_intensity && names_intensity(field.name);
      has_intensity = has_intensity || intensity;
      columns_.push_back(intensity ? &set_.intensity : &set_.scalars[field.name]);
    }
    if (!ignored.empty()) info_.notes.push_back("fields ignored: " + ignored);
  }

  /// Memory for all points at once; their number was checked against the size of the file.
  void reserve() {
    set_.points.reserve(header_.points);
    if (normals_) set_.normals.reserve(header_.points);
    if (packed_color_ != 0) set_.colors.reserve(header_.points);
    for (std::vector<double>* column : columns_) column->reserve(header_.points);
  }

  /// The value of a used field in binary data. A colour is four bytes, whatever type the header gives them.
  double binary_value(const char* p, std::size_t k) const {
    if (k != packed_color_ || k == 0) return field_value(p, *used_[k]);
    std::uint32_t packed;
    std::memcpy(&packed, p, 4);
    return packed;
  }

  void report(Context& context, std::uint64_t i) const {
    if (i % checkpoint_interval != 0) return;
    context.checkpoint();
    context.progress("read", static_cast<double>(i) / static_cast<double>(header_.points));
  }

  void add(const std::vector<double>& v, std::uint64_t i, IoError::Unit unit, std::uint64_t position) {
    if (std::isnan(v[0]) && std::isnan(v[1]) && std::isnan(v[2])) {
      ++info_.points_skipped;
      return;
    }
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
      throw IoError(file_, fmt::format("point {} ({} {} {}) is not finite", i, v[0], v[1], v[2]), unit, position);
    set_.points.emplace_back(v[0], v[1], v[2]);
    if (normals_) {
      const bool known = std::isfinite(v[3]) && std::isfinite(v[4]) && std::isfinite(v[5]);
      unknown_normals_ += !known;
      set_.normals.push_back(known ? Vec3(v[3], v[4], v[5]) : Vec3(0, 0, 0));
    }
    if (packed_color_ != 0) {
      const auto packed = static_cast<std::uint32_t>(v[packed_color_]);
      set_.colors.push_back({static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 8),
                             static_cast<std::uint8_t>(packed)});
    }
    const std::size_t first = v.size() - columns_.size();
    for (std::size_t k = 0; k < columns_.size(); ++k) columns_[k]->push_back(v[first + k]);
  }

  /// In text a packed colour is the number that its type makes of the four bytes.
  double packed_from_text(double value) const {
    if (std::isnan(value)) return 0;  // not known
    if (packed_as_float_) return std::bit_cast<std::uint32_t>(static_cast<float>(value));
    return value >= 0 && value <= 4294967295.0 ? value : 0;
  }

  void read_ascii(Context& context) {
    TextScanner scanner(bytes_, file_);
    scanner.move_to(bytes_.data() + header_.size);
    // A value and what ends it are two bytes.
    if (header_.points * header_.values > (scanner.remaining() + 1) / 2)
      truncated(2 * header_.points * header_.values, scanner.remaining());
    reserve();
    std::vector<double> v(used_.size());
    for (std::uint64_t i = 0; i < header_.points; ++i) {
      report(context, i);
      if (!scanner.next_filled_line('#')) scanner.fail(fmt::format("truncated: {} of {} points", i, header_.points));
      const char* first = scanner.position();
      std::size_t column = 0;
      for (const Field& field : header_.fields) {
        const auto used = std::find(used_.begin(), used_.end(), &field);
        for (std::uint64_t k = 0; k < field.count; ++k, ++column) {
          if (used != used_.end())
            v[static_cast<std::size_t>(used - used_.begin())] = scanner.number(field.name.c_str());
          else if (scanner.token().empty())
            scanner.fail(fmt::format("the line ends where {} should be", field.name), first);
        }
      }
      if (!scanner.at_line_end()) scanner.fail("more values than fields", first);
      scanner.next_line();
      if (packed_color_ != 0) v[packed_color_] = packed_from_text(v[packed_color_]);
      // The line is only counted if the point is refused.
      const bool fine = std::isnan(v[0]) == std::isnan(v[1]) && std::isnan(v[0]) == std::isnan(v[2]) &&
                        !std::isinf(v[0]) && !std::isinf(v[1]) && !std::isinf(v[2]);
      add(v, i, IoError::Unit::line, fine ? 0 : line_of(bytes_, first));
    }
    if (scanner.next_filled_line('#'))
      info_.notes.push_back(
          fmt::format("what follows the last point was left out, from {}", io_detail::quoted(scanner.rest_of_line())));
  }

  // Two 32-bit sizes, then LZF data: all values of the first field, all of the second …
  void read_compressed(std::string_view body, Context& context) {
    std::uint32_t packed = 0, unpacked = 0;
    if (body.size() < 8) truncated(8, body.size());
    std::memcpy(&packed, body.data(), 4);
    std::memcpy(&unpacked, body.data() + 4, 4);
    const std::uint64_t wanted = header_.points * header_.point_size;
    if (unpacked != wanted)
      throw IoError(
          file_, fmt::format("{} points need {} bytes, the compressed data holds {}", header_.points, wanted, unpacked),
          IoError::Unit::byte, header_.size + 4);
    if (packed > body.size() - 8) truncated(packed, body.size() - 8);
    // Three bytes of LZF stand for at most 264.
    if (wanted > std::uint64_t{packed} * 88 + 264) truncated(wanted / 88, packed);
    std::string values(wanted, '\0');
    decompress(body.substr(8, packed), values);
    reserve();
    std::vector<double> v(used_.size());
    for (std::uint64_t i = 0; i < header_.points; ++i) {
      report(context, i);
      for (std::size_t k = 0; k < used_.size(); ++k)
        v[k] = binary_value(values.data() + header_.points * used_[k]->offset + i * used_[k]->size, k);
      add(v, i, IoError::Unit::byte, header_.size);
    }
  }

  void decompress([[maybe_unused]] std::string_view packed, [[maybe_unused]] std::string& values) const {
#ifdef TRI_WITH_LZF
    if (values.empty()) return;
    const unsigned int size = lzf_decompress(packed.data(), static_cast<unsigned int>(packed.size()), values.data(),
                                             static_cast<unsigned int>(values.size()));
    if (size != values.size())
      throw IoError(file_, "the compressed data is broken", IoError::Unit::byte, header_.size + 8);
#else
    throw IoError(file_, "binary_compressed PCD is not read: this program was built without liblzf");
#endif
  }

  std::string_view bytes_;
  const std::string& file_;
  PointsFileInfo& info_;
  PcdHeader header_;
  std::vector<const Field*> used_;             // coordinates, normals, packed colour, then one per column
  std::vector<std::vector<double>*> columns_;  // intensity and scalars
  bool normals_ = false;
  std::size_t packed_color_ = 0;  // index into used_; 0: none
  bool packed_as_float_ = false;
  std::uint64_t unknown_normals_ = 0;
  PointSet set_;
};

}  // namespace

bool has_pcd_header(std::string_view bytes) {
  if (bytes.starts_with("# .PCD")) return true;
  const std::string file;
  TextScanner scanner(bytes.substr(0, 4096), file);
  if (!scanner.next_filled_line('#')) return false;
  const std::string_view word = scanner.token();
  return word == "VERSION" || word == "FIELDS";
}

PointSet parse_pcd(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info) {
  info.format = PointsFormat::pcd;
  return PcdParser(bytes, file, info).run(context);
}

}  // namespace tri::io_detail
