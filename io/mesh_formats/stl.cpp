#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/mesh_formats/float_rounding.hpp"
#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/polygon.hpp"
#include "io/text_number.hpp"
#include "io/text_scanner.hpp"

// STL: "StereoLithography Interface Specification", 3D Systems, 1989. A binary file has a header of 80 bytes, the
// number of facets as a 32-bit integer, and 50 bytes a facet: normal and three corners as floats, and two bytes of
// attributes.
namespace tri::io_detail {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little endian");

constexpr std::size_t stl_header_size = 84;
constexpr std::size_t facet_size = 50;

std::uint64_t binary_facets(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  return count;
}

// Gives identical coordinates the same vertex, in order of first occurrence.
class ExactWelder {
 public:
  ExactWelder(std::vector<Vec3>& points, std::size_t expected) : points_(points) {
    slots_.assign(std::bit_ceil(std::max<std::size_t>(expected * 2, 64)), none);
  }

  std::uint32_t vertex(const Vec3& p) {
    if (points_.size() * 2 >= slots_.size()) grow();
    std::size_t at = slot(p);
    while (slots_[at] != none) {
      if (points_[slots_[at]] == p) return slots_[at];
      at = (at + 1) & (slots_.size() - 1);
    }
    if (points_.size() >= none) throw Error("more vertices than a 32-bit index counts");
    slots_[at] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    return slots_[at];
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::size_t slot(const Vec3& p) const {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      // Adding 0 turns -0 into 0, which compares equal and so must hash equal.
      hash = (hash ^ std::bit_cast<std::uint64_t>(p[k] + 0.0)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash) & (slots_.size() - 1);
  }
  void grow() {
    slots_.assign(slots_.size() * 2, none);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::size_t at = slot(points_[i]);
      while (slots_[at] != none) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = static_cast<std::uint32_t>(i);
    }
  }

  std::vector<Vec3>& points_;
  std::vector<std::uint32_t> slots_;
};

Soup parse_binary(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info) {
  info.encoding = MeshEncoding::binary_little_endian;
  if (bytes.size() < stl_header_size)
    throw IoError(
        file, fmt::format("is neither an ASCII STL nor as long as the header of a binary one: {} bytes", bytes.size()));
  const std::uint64_t facets = binary_facets(bytes);
  const std::uint64_t wanted = stl_header_size + facets * facet_size;
  if (wanted > bytes.size())
    throw IoError(file,
                  fmt::format("truncated or not an STL file: {} facets in the header need {} bytes", facets, wanted),
                  IoError::Unit::byte, bytes.size());
  if (facets == 0 && bytes.size() > stl_header_size)
    throw IoError(file, fmt::format("the header says 0 facets, but {} bytes follow", bytes.size() - stl_header_size),
                  IoError::Unit::byte, 80);

  Soup soup;
  soup.triangles.reserve(facets);
  soup.points.reserve(facets / 2 + 2);
  ExactWelder welder(soup.points, facets / 2 + 2);
  for (std::uint64_t i = 0; i < facets; ++i) {
    if (i % checkpoint_interval == 0) {
      context.checkpoint();
      context.progress("read", static_cast<double>(i) / static_cast<double>(facets));
    }
    const std::size_t at = stl_header_size + i * facet_size;
    std::array<float, 9> xyz;
    std::memcpy(xyz.data(), bytes.data() + at + 12, sizeof xyz);
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p(xyz[3 * k], xyz[3 * k + 1], xyz[3 * k + 2]);
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
        throw IoError(file, fmt::format("facet {} has a coordinate that is not finite", i + 1), IoError::Unit::byte,
                      at + 12 + 12 * k);
      triangle[k] = welder.vertex(p);
    }
    soup.triangles.push_back(triangle);
    std::uint16_t attribute = 0;
    std::memcpy(&attribute, bytes.data() + at + 48, 2);
    if (attribute != 0) {
      auto& values = soup.face_scalars["attribute"];
      values.resize(facets, 0);
      values[i] = attribute;
    }
  }
  info.polygons = facets;
  info.parts.emplace_back();
  if (bytes.size() > wanted)
    info.notes.push_back(fmt::format("{} bytes after the last facet were left out", bytes.size() - wanted));
  return soup;
}

bool is_word(std::string_view token, std::string_view lower_case) {
  if (token.size() != lower_case.size()) return false;
  for (std::size_t i = 0; i < token.size(); ++i)
    if ((token[i] | 0x20) != lower_case[i]) return false;
  return true;
}

class AsciiParser {
 public:
  AsciiParser(std::string_view bytes, const std::string& file, MeshFileInfo& info)
      : scanner_(bytes, file), info_(info), size_(bytes.size()), welder_(soup_.points, bytes.size() / 500) {}

  Soup run(Context& context) {
    info_.encoding = MeshEncoding::ascii;
    bool in_solid = false;
    std::size_t facets = 0;
    while (true) {
      const std::string_view word = scanner_.token_across_lines();
      if (word.empty()) break;
      if (!in_solid && is_word(word, "solid")) {
        in_solid = true;
        std::string_view name = scanner_.rest_of_line();
        while (!name.empty() && TextScanner::blank(name.front())) name.remove_prefix(1);
        while (!name.empty() && TextScanner::blank(name.back())) name.remove_suffix(1);
        info_.parts.emplace_back(name);
      } else if (in_solid && is_word(word, "facet")) {
        facet();
        if (++facets % (checkpoint_interval / 8) == 0) {
          context.checkpoint();
          context.progress("read", static_cast<double>(scanner_.offset()) / static_cast<double>(size_));
        }
      } else if (in_solid && is_word(word, "endsolid")) {
        in_solid = false;
        scanner_.rest_of_line();
      } else {
        unexpected(word, in_solid ? "facet or endsolid" : "solid");
      }
    }
    if (in_solid) scanner_.fail("truncated: the file ends without endsolid");
    collector_.finish(soup_, info_, context);
    return std::move(soup_);
  }

 private:
  [[noreturn]] void unexpected(std::string_view found, const char* wanted) {
    if (found.empty()) scanner_.fail(fmt::format("truncated: the file ends where {} should be", wanted));
    scanner_.fail(fmt::format("{} where {} should be", quoted(found), wanted), found.data());
  }

  void facet() {
    // The normal is not needed, and what stands there need not be a number ("-nan(ind)").
    std::string_view word = scanner_.token_across_lines();
    for (int i = 0; i < 4 && !is_word(word, "outer"); ++i) word = scanner_.token_across_lines();
    if (!is_word(word, "outer")) unexpected(word, "outer loop");
    word = scanner_.token_across_lines();
    if (!is_word(word, "loop")) unexpected(word, "loop");
    corners_.clear();
    while (is_word(word = scanner_.token_across_lines(), "vertex")) {
      const double x = scanner_.coordinate("x");
      const double y = scanner_.coordinate("y");
      const double z = scanner_.coordinate("z");
      corners_.push_back(welder_.vertex(Vec3(x, y, z)));
    }
    if (!is_word(word, "endloop")) unexpected(word, "vertex or endloop");
    if (corners_.size() < 3) scanner_.fail(fmt::format("a facet of {} vertices", corners_.size()), word.data());
    collector_.add(corners_);
    word = scanner_.token_across_lines();
    if (!is_word(word, "endfacet")) unexpected(word, "endfacet");
  }

  TextScanner scanner_;
  MeshFileInfo& info_;
  std::size_t size_;
  Soup soup_;
  ExactWelder welder_;
  PolygonCollector collector_;
  std::vector<std::uint32_t> corners_;
};

// "solid" at the beginning proves nothing: many binary headers begin with it.
bool is_ascii(std::string_view bytes) {
  if (has_binary_stl_size(bytes)) return false;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || !is_word(bytes.substr(first, 5), "solid")) return false;
  return bytes.substr(0, 4096).find('\0') == std::string_view::npos;
}

std::array<float, 3> to_floats(const Vec3& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  Vec3 normal = (b - a) % (c - a);
  const double largest = std::max({std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])});
  if (!(largest > 0) || !std::isfinite(largest)) return {0, 0, 0};
  normal /= largest;  // its square neither vanishes nor overflows then
  return normal / std::sqrt(normal | normal);
}

void write_binary_stl(AtomicFile& file, const Soup& soup, Context& context, MeshWriteReport& report) {
  if (soup.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("a binary STL file counts its facets in 32 bits");
  note_rounding_to_floats(soup, "binary STL", report);

  std::array<char, 80> header{};
  constexpr std::string_view title = "binary STL written by tri";
  std::memcpy(header.data(), title.data(), title.size());
  file.write({header.data(), header.size()});
  file.write_value(static_cast<std::uint32_t>(soup.triangles.size()));
  const auto attribute = soup.face_scalars.find("attribute");
  const bool with_attribute = attribute != soup.face_scalars.end() && is_stl_attribute(attribute->second);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    if (i % checkpoint_interval == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / static_cast<double>(soup.triangles.size()));
    }
    std::array<std::array<float, 3>, 4> facet;
    std::array<Vec3, 3> rounded;
    const Triangle& triangle = soup.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      facet[k + 1] = to_floats(soup.points[triangle[k]]);
      rounded[k] = Vec3(facet[k + 1][0], facet[k + 1][1], facet[k + 1][2]);
    }
    facet[0] = to_floats(unit_normal(rounded[0], rounded[1], rounded[2]));
    file.write_value(facet);
    file.write_value(with_attribute ? static_cast<std::uint16_t>(attribute->second[i]) : std::uint16_t{0});
  }
}

void write_ascii(AtomicFile& file, const Soup& soup, Context& context) {
  TextWriter out(file);
  out << "solid tri\n";
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    if (i % checkpoint_interval == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / static_cast<double>(soup.triangles.size()));
    }
    const Triangle& t = soup.triangles[i];
    const auto n = to_floats(unit_normal(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]));
    out << "  facet normal " << n[0] << ' ' << n[1] << ' ' << n[2] << "\n    outer loop\n";
    for (const std::uint32_t v : t) {
      const Vec3& p = soup.points[v];
      out << "      vertex " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    }
    out << "    endloop\n  endfacet\n";
  }
  out << "endsolid tri\n";
}

}  // namespace

bool is_stl_attribute(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v >= 0 && v <= 65535 && v == std::floor(v); });
}

bool has_binary_stl_size(std::string_view bytes) {
  return bytes.size() > stl_header_size && bytes.size() == stl_header_size + binary_facets(bytes) * facet_size;
}

Soup parse_stl(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info) {
  info.format = MeshFormat::stl;
  if (is_ascii(bytes)) return AsciiParser(bytes, file, info).run(context);
  return parse_binary(bytes, file, context, info);
}

void write_stl(AtomicFile& file, const Soup& soup, bool ascii, Context& context, MeshWriteReport& report) {
  if (ascii)
    write_ascii(file, soup, context);
  else
    write_binary_stl(file, soup, context, report);
}

}  // namespace tri::io_detail
