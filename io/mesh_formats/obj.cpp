#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/polygon.hpp"
#include "io/text_number.hpp"
#include "io/text_scanner.hpp"

// OBJ: "Object Files (.obj)", Alias|Wavefront, Advanced Visualizer manual, appendix B1; vertex colours after the
// coordinates are a common extension.
namespace tri::io_detail {
namespace {

// What the specification knows and a triangle mesh has no place for.
constexpr std::array<std::string_view, 29> other_keywords = {
    "s",     "mtllib",   "vp",       "cstype", "deg",        "bmat",      "step",  "p",     "l",     "curv",
    "curv2", "surf",     "parm",     "trim",   "hole",       "scrv",      "sp",    "end",   "con",   "mg",
    "bevel", "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj", "ctech", "stech", "maplib"};

// A backslash at the end of a line continues it. It and the line end become blanks, so that every offset stays.
std::string without_continuations(std::string_view bytes) {
  std::string text(bytes);
  for (std::size_t at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
    if (at + 1 >= text.size() || !TextScanner::line_end(text[at + 1])) continue;
    const bool two = text[at + 1] == '\r' && at + 2 < text.size() && text[at + 2] == '\n';
    text[at] = text[at + 1] = ' ';
    if (two) text[at + 2] = ' ';
  }
  return text;
}

bool has_continuation(std::string_view bytes) {
  for (std::size_t at = bytes.find('\\'); at != std::string_view::npos; at = bytes.find('\\', at + 1))
    if (at + 1 < bytes.size() && TextScanner::line_end(bytes[at + 1])) return true;
  return false;
}

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& file, std::string_view original, MeshFileInfo& info)
      : scanner_(text, file, original), info_(info), size_(text.size()) {}

  Soup run(Context& context) {
    info_.encoding = MeshEncoding::ascii;
    std::size_t lines = 0;
    while (scanner_.next_filled_line('#')) {
      if (lines++ % checkpoint_interval == 0) {
        context.checkpoint();
        context.progress("read", static_cast<double>(scanner_.offset()) / static_cast<double>(size_));
      }
      const char* first = scanner_.position();
      const std::string_view keyword = scanner_.token();
      if (keyword == "v")
        vertex();
      else if (keyword == "f" || keyword == "fo")
        face();
      else if (keyword == "vn")
        normals_.push_back(vector("normal"));
      else if (keyword == "vt")
        texture_coordinate();
      else if (keyword == "o" || keyword == "g" || keyword == "usemtl")
        part(keyword);
      else if (std::find(other_keywords.begin(), other_keywords.end(), keyword) != other_keywords.end())
        ++others_[std::string(keyword)];
      else
        scanner_.fail("unknown keyword " + quoted(keyword), first);
      scanner_.next_line();
    }
    check_later_references();
    if (soup_.points.empty()) scanner_.fail("not an OBJ mesh: the file ends without a vertex");
    if (has_texture_ || !normals_.empty()) collector_.name_corner_columns({"s", "t", "normal"});
    collector_.finish(soup_, info_, context);
    keep_colors();
    keep_normals();
    soup_.corner_scalars.erase("normal");
    if (!has_texture_) soup_.corner_scalars.erase("s"), soup_.corner_scalars.erase("t");
    keep_parts();
    if (info_.parts.empty()) info_.parts.emplace_back();
    notes();
    return std::move(soup_);
  }

 private:
  struct Reference {
    std::int64_t largest = -1;
    const char* where = nullptr;
  };

  Vec3 vector(const char* what) {
    const double x = scanner_.number(what);
    const double y = scanner_.number(what);
    const double z = scanner_.number(what);
    return {x, y, z};
  }

  void vertex() {
    if (soup_.points.size() >= std::numeric_limits<std::uint32_t>::max())
      scanner_.fail("more vertices than a 32-bit index counts");
    const double x = scanner_.coordinate("x");
    const double y = scanner_.coordinate("y");
    const double z = scanner_.coordinate("z");
    soup_.points.emplace_back(x, y, z);
    if (scanner_.at_line_end('#')) return;
    std::array<double, 5> values{};
    std::size_t count = 0;
    while (!scanner_.at_line_end('#')) {
      const double value = scanner_.number("a weight or colour");
      if (count == values.size()) scanner_.fail("more than 8 values of a vertex");
      values[count++] = value;
    }
    if (count == 1) {
      weights_ += values[0] != 1;
    } else if (count == 3 || count == 4) {
      colors_.resize(soup_.points.size() - 1, {-1, -1, -1});
      for (int k = 0; k < 3; ++k)
        if (!(values[k] >= 0 && values[k] <= 255))
          scanner_.fail(fmt::format("colour value {} is outside of 0 to 255", values[k]));
      colors_.push_back({static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2])});
      ++colored_;
    } else {
      ++odd_vertices_;
    }
  }

  void texture_coordinate() {
    const double s = scanner_.number("u");
    const double t = scanner_.at_line_end('#') ? 0 : scanner_.number("v");
    textures_at_.push_back({s, t});
  }

  /// Triangles from here on are of this object, group or material.
  struct Part {
    std::size_t first_triangle;
    double label;
  };
  struct PartList {
    std::vector<std::string> names;
    std::vector<Part> parts;
  };

  void part(std::string_view keyword) {
    scanner_.skip_blanks();
    std::string_view name = scanner_.rest_of_line();
    while (!name.empty() && TextScanner::blank(name.back())) name.remove_suffix(1);
    if (keyword != "usemtl") info_.parts.emplace_back(name);
    PartList& list = keyword == "g" ? groups_ : keyword == "o" ? objects_ : materials_;
    auto found = std::find(list.names.begin(), list.names.end(), name);
    if (found == list.names.end()) found = list.names.emplace(list.names.end(), name);
    list.parts.push_back({collector_.triangles(), static_cast<double>(found - list.names.begin())});
  }

  void keep_parts() {
    const auto keep = [&](const char* scalar, const PartList& list) {
      if (list.names.empty()) return;
      std::vector<double>& values = soup_.face_scalars[scalar];
      values.assign(soup_.triangles.size(), -1);  // before the first part: none
      for (std::size_t i = 0; i < list.parts.size(); ++i) {
        const std::size_t end = i + 1 < list.parts.size() ? list.parts[i + 1].first_triangle : values.size();
        for (std::size_t t = list.parts[i].first_triangle; t < end; ++t) values[t] = list.parts[i].label;
      }
      soup_.face_labels[scalar] = list.names;
    };
    keep("group", groups_);
    keep("object", objects_);
    keep("material", materials_);
  }

  // One index of "v/vt/vn": 1-based, or negative and counted back from the last. Returns it 0-based; those of elements
  // that come later in the file are checked at its end.
  std::int64_t index(std::string_view text, std::int64_t defined, Reference& reference, const char* what,
                     std::string_view corner) {
    std::int64_t value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size())
      scanner_.fail(fmt::format("{} in {} is not an index", what, quoted(corner)), corner.data());
    if (value == 0)
      scanner_.fail(fmt::format("{} index 0 in {}: indices begin with 1", what, quoted(corner)), corner.data());
    if (value < 0 && -(value + 1) >= defined)
      scanner_.fail(fmt::format("{} index {} counts back beyond the first of {}", what, value, defined), corner.data());
    if (value > std::numeric_limits<std::uint32_t>::max())
      scanner_.fail(fmt::format("{} index {} is out of range", what, value), corner.data());
    value = value < 0 ? defined + value : value - 1;
    if (value > reference.largest) reference = {value, corner.data()};
    return value;
  }

  void face() {
    corners_.clear();
    corner_normals_.clear();
    corner_values_.clear();
    bool textured = true, with_normals = false;
    while (!scanner_.at_line_end('#')) {
      const std::string_view corner = scanner_.token();
      const std::size_t slash = corner.find('/');
      const std::int64_t v =
          index(corner.substr(0, slash), static_cast<std::int64_t>(soup_.points.size()), vertices_, "vertex", corner);
      std::int64_t n = -1, texture = -1;
      if (slash != std::string_view::npos) {
        const std::string_view rest = corner.substr(slash + 1);
        const std::size_t second = rest.find('/');
        const auto t = rest.substr(0, second);
        if (!t.empty())
          texture = index(t, static_cast<std::int64_t>(textures_at_.size()), textures_, "texture", corner);
        if (second != std::string_view::npos && second + 1 < rest.size())
          n = index(rest.substr(second + 1), static_cast<std::int64_t>(normals_.size()), normal_references_, "normal",
                    corner);
      }
      textured = textured && texture >= 0;
      with_normals = with_normals || n >= 0;
      // One that comes later in the file is rare enough to be lost; a note says so.
      const bool known = texture >= 0 && texture < static_cast<std::int64_t>(textures_at_.size());
      textures_later_ += texture >= 0 && !known;
      constexpr double none = std::numeric_limits<double>::quiet_NaN();
      for (std::size_t k = 0; k < 2; ++k)
        corner_values_.push_back(known ? textures_at_[static_cast<std::size_t>(texture)][k] : none);
      corner_values_.push_back(static_cast<double>(n));
      corners_.push_back(static_cast<std::uint32_t>(v));
      corner_normals_.push_back(n);
    }
    if (!textured)
      for (std::size_t i = 0; i < corner_values_.size(); ++i)
        if (i % 3 != 2) corner_values_[i] = std::numeric_limits<double>::quiet_NaN();
    has_texture_ = has_texture_ || (textured && !corners_.empty());
    if (!textured && !with_normals) corner_values_.clear();
    collector_.add(corners_, corner_values_, 3);
    if (!normals_differ_) note_normals();
  }

  // A vertex has a normal of its own if all corners at it name the same one.
  void note_normals() {
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const std::size_t v = corners_[i];
      if (v >= vertex_normal_.size()) {
        // Not `v + 1` entries at once: an index may be absurd, which only the end of the file tells.
        if (v >= soup_.points.size()) {
          normals_differ_ = true;
          return;
        }
        vertex_normal_.resize(soup_.points.size(), -2);
      }
      if (vertex_normal_[v] == -2) vertex_normal_[v] = corner_normals_[i];
      if (vertex_normal_[v] != corner_normals_[i]) normals_differ_ = true;
    }
  }

  void check_later_references() const {
    const auto check = [this](const Reference& reference, std::size_t defined, const char* what) {
      if (reference.largest >= static_cast<std::int64_t>(defined))
        scanner_.fail(fmt::format("{} index {} of a file with {}", what, reference.largest + 1, defined),
                      reference.where);
    };
    check(vertices_, soup_.points.size(), "vertex");
    check(textures_, textures_at_.size(), "texture");
    check(normal_references_, normals_.size(), "normal");
  }

  void keep_colors() {
    if (colored_ == 0) return;
    if (colored_ != soup_.points.size()) {
      info_.notes.push_back(
          fmt::format("only {} of {} vertices have a colour: colours are not kept", colored_, soup_.points.size()));
      return;
    }
    float largest = 0;
    for (const auto& c : colors_) largest = std::max({largest, c[0], c[1], c[2]});
    const float scale = largest > 1 ? 1.f : 255.f;  // some programs count to 255, most to 1
    soup_.vertex_colors.reserve(colors_.size());
    for (const auto& c : colors_) {
      const auto level = [scale](float value) { return static_cast<std::uint8_t>(std::lround(value * scale)); };
      soup_.vertex_colors.push_back({level(c[0]), level(c[1]), level(c[2])});
    }
  }

  void keep_normals() {
    if (normals_.empty()) return;
    vertex_normal_.resize(soup_.points.size(), -2);
    const bool all = std::all_of(vertex_normal_.begin(), vertex_normal_.end(), [](std::int64_t n) { return n >= 0; });
    if (normals_differ_ || !all) {
      keep_corner_normals();
      return;
    }
    soup_.vertex_normals.reserve(soup_.points.size());
    for (const std::int64_t n : vertex_normal_) soup_.vertex_normals.push_back(normals_[static_cast<std::size_t>(n)]);
  }

  /// Of vertices that have several; by the number of the normal of each corner.
  void keep_corner_normals() {
    const auto numbers = soup_.corner_scalars.find("normal");
    const bool any = numbers != soup_.corner_scalars.end() &&
                     std::any_of(numbers->second.begin(), numbers->second.end(), [](double n) { return n >= 0; });
    if (!any) {
      info_.notes.push_back(fmt::format("{} normals are not kept: no face uses them", normals_.size()));
      return;
    }
    static constexpr const char* names[] = {"nx", "ny", "nz"};
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double>& values = soup_.corner_scalars[names[k]];
      values.reserve(numbers->second.size());
      for (const double n : numbers->second)
        values.push_back(n >= 0 ? normals_[static_cast<std::size_t>(n)][k] : std::numeric_limits<double>::quiet_NaN());
    }
  }

  void notes() {
    if (!has_texture_ && !textures_at_.empty())
      info_.notes.push_back(fmt::format("{} texture coordinates are not kept: no face uses them", textures_at_.size()));
    if (textures_later_ > 0)
      info_.notes.push_back(
          fmt::format("texture coordinates of {} corners are not kept: they come after their faces", textures_later_));
    if (weights_ > 0) info_.notes.push_back(fmt::format("the weights of {} vertices are not kept", weights_));
    if (odd_vertices_ > 0)
      info_.notes.push_back(
          fmt::format("{} vertices have 5 or 8 values; those after the third are not kept", odd_vertices_));
    std::string list;
    for (const auto& [keyword, count] : others_)
      list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, keyword);
    if (!list.empty()) info_.notes.push_back("lines with no place in a triangle mesh are not kept: " + list);
  }

  TextScanner scanner_;
  MeshFileInfo& info_;
  std::size_t size_;
  Soup soup_;
  PolygonCollector collector_;
  std::vector<std::uint32_t> corners_;
  std::vector<std::int64_t> corner_normals_;
  std::vector<Vec3> normals_;
  std::vector<std::int64_t> vertex_normal_;  // -2: no face has named the vertex, -1: without a normal
  std::vector<std::array<float, 3>> colors_;
  bool normals_differ_ = false;
  std::size_t colored_ = 0;
  std::vector<std::array<double, 2>> textures_at_;
  std::vector<double> corner_values_;
  bool has_texture_ = false;
  std::uint64_t textures_later_ = 0;
  PartList groups_, objects_, materials_;
  std::uint64_t weights_ = 0, odd_vertices_ = 0;
  Reference vertices_, textures_, normal_references_;
  std::map<std::string, std::uint64_t> others_;
};

}  // namespace

Soup parse_obj(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info) {
  info.format = MeshFormat::obj;
  if (!has_continuation(bytes)) return ObjParser(bytes, file, bytes, info).run(context);
  const std::string text = without_continuations(bytes);
  return ObjParser(text, file, bytes, info).run(context);
}

namespace {

/// Writes "usemtl NAME" and the like wherever the part of the triangles changes.
class PartWriter {
 public:
  PartWriter(const Soup& soup, const char* scalar, std::string_view keyword) : scalar_(scalar), keyword_(keyword) {
    const auto values = soup.face_scalars.find(scalar);
    const auto labels = soup.face_labels.find(scalar);
    if (values == soup.face_scalars.end() || labels == soup.face_labels.end()) return;
    values_ = &values->second;
    labels_ = &labels->second;
  }
  void before(std::size_t triangle, TextWriter& out) {
    if (!values_ || (*values_)[triangle] == last_) return;
    const double value = (*values_)[triangle];
    const bool named = value >= 0 && value < static_cast<double>(labels_->size()) && value == std::floor(value);
    if (!named) {  // what has no part stays in the one before, as in every OBJ file
      absorbed_ += last_ >= 0;
      return;
    }
    last_ = value;
    out << keyword_ << ' ' << one_line((*labels_)[static_cast<std::size_t>(value)]) << '\n';
  }

  void note(MeshWriteReport& report) const {
    if (absorbed_ > 0)
      report.notes.push_back(fmt::format("{} triangles without a {} come after some with one, to which OBJ counts them",
                                         absorbed_, scalar_));
    if (odd_names_ > 0)
      report.notes.push_back(
          fmt::format("{} names of a {} were written without line ends and the like", odd_names_, scalar_));
  }

 private:
  /// A name that stays within its line, and is read as it is written.
  std::string one_line(std::string name) {
    const std::string as_it_was = name;
    for (char& c : name)
      if (static_cast<unsigned char>(c) < 32) c = ' ';
    while (!name.empty() && (name.back() == ' ' || name.back() == '\\')) name.pop_back();
    name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
    odd_names_ += name != as_it_was;
    return name;
  }

  const char* scalar_;
  std::string_view keyword_;
  std::uint64_t absorbed_ = 0, odd_names_ = 0;
  const std::vector<double>* values_ = nullptr;
  const std::vector<std::string>* labels_ = nullptr;
  double last_ = -1;
};

/// Values of corners (texture coordinates, normals) without repetition, and which each corner has; 0 for none.
template <std::size_t size>
struct CornerTable {
  std::vector<std::array<double, size>> rows;
  std::vector<std::uint64_t> of_corner;

  /// Of the corner scalars of these names, where all are finite; empty unless the soup has them all.
  CornerTable(const Soup& soup, const std::array<const char*, size>& names) {
    std::array<const std::vector<double>*, size> columns;
    for (std::size_t k = 0; k < size; ++k) {
      const auto found = soup.corner_scalars.find(names[k]);
      if (found == soup.corner_scalars.end()) return;
      columns[k] = &found->second;
    }
    std::map<std::array<double, size>, std::uint64_t> number;
    of_corner.assign(3 * soup.triangles.size(), 0);
    for (std::size_t i = 0; i < of_corner.size(); ++i) {
      std::array<double, size> row;
      for (std::size_t k = 0; k < size; ++k) row[k] = (*columns[k])[i];
      if (!std::all_of(row.begin(), row.end(), [](double v) { return std::isfinite(v); })) continue;
      const auto [found, is_new] = number.emplace(row, rows.size() + 1);
      if (is_new) rows.push_back(row);
      of_corner[i] = found->second;
    }
  }
};

}  // namespace

void write_obj(AtomicFile& file, const Soup& soup, Context& context, MeshWriteReport& report) {
  TextWriter out(file);
  const bool colors = !soup.vertex_colors.empty();
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    if (i % checkpoint_interval == 0) context.checkpoint();
    const Vec3& p = soup.points[i];
    out << "v " << p[0] << ' ' << p[1] << ' ' << p[2];
    if (colors)
      for (const std::uint8_t c : soup.vertex_colors[i]) out << ' ' << static_cast<float>(c) / 255.f;
    out << '\n';
  }
  const CornerTable<2> textures(soup, {"s", "t"});
  const CornerTable<3> corner_normals(soup, {"nx", "ny", "nz"});
  for (const auto& [s, t] : textures.rows) out << "vt " << s << ' ' << t << '\n';
  for (const auto& n : corner_normals.rows) out << "vn " << n[0] << ' ' << n[1] << ' ' << n[2] << '\n';
  const bool normals = !soup.vertex_normals.empty() && corner_normals.rows.empty();
  if (normals)
    for (const Vec3& n : soup.vertex_normals) out << "vn " << n[0] << ' ' << n[1] << ' ' << n[2] << '\n';
  std::uint64_t half_textured = 0;
  PartWriter objects(soup, "object", "o"), groups(soup, "group", "g"), materials(soup, "material", "usemtl");
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    if (i % checkpoint_interval == 0) {
      context.checkpoint();
      context.progress("write", static_cast<double>(i) / static_cast<double>(soup.triangles.size()));
    }
    for (PartWriter* part : {&objects, &groups, &materials}) part->before(i, out);
    out << 'f';
    // A face either has texture coordinates at every corner or at none.
    bool textured = !textures.of_corner.empty();
    bool half = false;
    for (std::size_t k = 0; k < 3 && !textures.of_corner.empty(); ++k) {
      textured = textured && textures.of_corner[3 * i + k] != 0;
      half = half || textures.of_corner[3 * i + k] != 0;
    }
    half_textured += half && !textured;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t v = soup.triangles[i][k] + 1ULL;
      out << ' ' << v;
      if (textured) out << '/' << textures.of_corner[3 * i + k];
      const std::uint64_t n = normals ? v : corner_normals.rows.empty() ? 0 : corner_normals.of_corner[3 * i + k];
      if (n > 0) out << (textured ? "/" : "//") << n;
    }
    out << '\n';
  }
  if (half_textured > 0)
    report.notes.push_back(
        fmt::format("texture coordinates of {} triangles were not written: not every corner has them", half_textured));
  for (const PartWriter* part : {&objects, &groups, &materials}) part->note(report);
}

}  // namespace tri::io_detail
