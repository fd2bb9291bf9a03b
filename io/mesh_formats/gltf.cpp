#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "io/mesh_formats/gltf_document.hpp"
#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/part_labels.hpp"
#include "io/mesh_formats/placement.hpp"

namespace tri::io_detail {
namespace {

using GltfJson = GltfDocument::Json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double millimetres = 1000;  // in the metre of glTF

/// Puts the meshes of a scene into one soup.
class SceneReader {
 public:
  SceneReader(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info)
      : document_(bytes, file, info), context_(context), info_(info), budget_(instance_budget(bytes.size())) {}

  Soup run() {
    for (const std::uint64_t node : roots()) walk(node);
    finish_attributes();
    finish_notes();
    info_.polygons = soup_.triangles.size();
    for (const std::string& name : objects_.names()) info_.parts.push_back(name);
    if (info_.parts.empty()) info_.parts.emplace_back();
    if (objects_.names().size() > 1 || named_) std::move(objects_).finish(soup_);
    std::move(materials_).finish(soup_);
    return std::move(soup_);
  }

 private:
  /// What the vertices of a primitive are: its accessors and its place.
  using VertexKey = std::pair<std::string, std::array<double, 12>>;

  std::vector<std::uint64_t> roots() {
    const GltfJson& root = document_.root();
    const GltfJson &scenes = document_.list(root, "scenes", "the file"),
                   &nodes = document_.list(root, "nodes", "the file");
    std::vector<std::uint64_t> result;
    if (!scenes.empty()) {
      const std::uint64_t number = document_.integer(root, "scene", "the file", 0);
      const GltfJson& scene = document_.element("scenes", number, "scene");
      if (scenes.size() > 1) note(fmt::format("of {} scenes, only number {} was taken", scenes.size(), number));
      return indices(scene, "nodes", fmt::format("scenes[{}]", number));
    }
    std::vector<bool> child(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (const std::uint64_t c :
           indices(document_.element("nodes", i, "nodes"), "children", fmt::format("nodes[{}]", i)))
        if (c < child.size()) child[c] = true;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!child[i]) result.push_back(i);
    return result;
  }

  std::vector<std::uint64_t> indices(const GltfJson& object, const char* name, const std::string& where) {
    std::vector<std::uint64_t> result;
    for (const GltfJson& value : document_.list(object, name, where)) {
      if (!value.is_number_unsigned()) document_.fail(where + "." + name, "holds what is no index");
      result.push_back(value.get<std::uint64_t>());
    }
    return result;
  }

  void walk(std::uint64_t root) {
    std::vector<std::pair<std::uint64_t, Placement>> stack{{root, Placement::scaled(millimetres)}};
    while (!stack.empty()) {
      context_.checkpoint();
      const auto [number, parent] = stack.back();
      stack.pop_back();
      const GltfJson& node = document_.element("nodes", number, "the node tree");
      const std::string where = fmt::format("nodes[{}]", number);
      if (!visited_.insert(number).second) document_.fail(where, "is reached twice: the nodes are no tree");
      const Placement placement = parent * local(node, where);
      if (node.contains("mesh")) mesh(document_.integer(node, "mesh", where), node, placement, where);
      if (node.contains("skin")) ++left_["skins"];
      if (node.contains("camera")) ++left_["cameras"];
      std::vector<std::uint64_t> children = indices(node, "children", where);
      for (auto child = children.rbegin(); child != children.rend(); ++child) stack.emplace_back(*child, placement);
    }
  }

  Placement local(const GltfJson& node, const std::string& where) {
    Placement placement;
    if (const auto m = document_.numbers(node, "matrix", 16, where); !m.empty()) {
      if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) document_.fail(where + ".matrix", "is not affine");
      for (std::size_t i = 0; i < 3; ++i) {
        placement.rows[i] = Vec3(m[i], m[4 + i], m[8 + i]);
        placement.offset[i] = m[12 + i];
      }
      return placement;
    }
    if (const auto q = document_.numbers(node, "rotation", 4, where); !q.empty()) {
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      if (!(length > 0)) document_.fail(where + ".rotation", "is no unit quaternion");
      const double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
      placement.rows = {Vec3(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                        Vec3(2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                        Vec3(2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y))};
    }
    if (const auto s = document_.numbers(node, "scale", 3, where); !s.empty())
      for (Vec3& row : placement.rows) row = Vec3(row[0] * s[0], row[1] * s[1], row[2] * s[2]);
    if (const auto t = document_.numbers(node, "translation", 3, where); !t.empty())
      placement.offset = Vec3(t[0], t[1], t[2]);
    return placement;
  }

  void mesh(std::uint64_t number, const GltfJson& node, const Placement& placement, const std::string& from) {
    const GltfJson& mesh = document_.element("meshes", number, from + ".mesh");
    const std::string where = fmt::format("meshes[{}]", number);
    std::string name = GltfDocument::text(node, "name");
    if (name.empty()) name = GltfDocument::text(mesh, "name");
    named_ = named_ || !name.empty();
    if (mesh.contains("weights")) ++left_["morph weights"];
    const GltfJson& primitives = document_.list(mesh, "primitives", where);
    const std::size_t before = soup_.triangles.size();
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const std::string place = fmt::format("{}.primitives[{}]", where, i);
      if (!primitives[i].is_object()) document_.fail(place, "is no object");
      primitive(primitives[i], placement, place);
    }
    if (soup_.triangles.size() > before)
      objects_.fill(soup_.triangles.size(), objects_.own_label(name.empty() ? fmt::format("mesh {}", number) : name));
  }

  void primitive(const GltfJson& primitive, const Placement& placement, const std::string& where) {
    const std::uint64_t mode = document_.integer(primitive, "mode", where, 4);
    if (mode > 6) document_.fail(where + ".mode", fmt::format("{} is unknown", mode));
    if (mode < 4) {
      ++left_[mode == 0 ? "primitives of points" : "primitives of lines"];
      return;
    }
    if (primitive.contains("targets")) ++left_["morph targets"];
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object() || !attributes->contains("POSITION")) {
      ++left_["primitives without positions"];
      return;
    }
    const auto [base, count] = vertices(*attributes, placement, where);
    std::vector<std::uint32_t> corners;
    if (primitive.contains("indices")) {
      const GltfValues values =
          document_.accessor(document_.integer(primitive, "indices", where), 1, 1, where + ".indices");
      spend(values.count, where);
      corners.reserve(values.count);
      for (const double v : values.values) {
        if (!(v >= 0 && v < static_cast<double>(count)) || v != std::floor(v))
          document_.fail(where + ".indices",
                         fmt::format("number {} is {}, but there are {} vertices", corners.size(), v, count));
        corners.push_back(base + static_cast<std::uint32_t>(v));
      }
    } else {
      spend(count, where);
      for (std::uint32_t v = 0; v < count; ++v) corners.push_back(base + v);
    }
    triangles(corners, mode, placement.determinant() < 0);
    double material = -1;
    if (primitive.contains("material")) {
      const std::uint64_t number = document_.integer(primitive, "material", where);
      const std::string name = GltfDocument::text(document_.element("materials", number, where + ".material"), "name");
      material = materials_.label(name.empty() ? fmt::format("material {}", number) : name);
    }
    materials_.fill(soup_.triangles.size(), material);
  }

  void triangles(const std::vector<std::uint32_t>& corners, std::uint64_t mode, bool mirrored) {
    const std::size_t step = mode == 4 ? 3 : 1;
    mirrored_ += mirrored;
    if (mode == 4 && corners.size() % 3 != 0) ++left_["lists with one or two corners too many"];
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      Triangle t{corners[mode == 6 ? 0 : i], corners[i + 1], corners[i + 2]};
      const bool turned = (mode == 5 && i % 2 == 1) != mirrored;
      if (turned) std::swap(t[1], t[2]);
      soup_.triangles.push_back(t);
    }
  }

  void spend(std::size_t elements, const std::string& where) {
    if (elements > budget_) document_.fail(where, "with it, more elements than a file of this size can mean: absurd");
    budget_ -= elements;
  }

  /// The vertices of a primitive, which may be those of an earlier one. @return the first, and how many
  std::pair<std::uint32_t, std::uint32_t> vertices(const GltfJson& attributes, const Placement& placement,
                                                   const std::string& where) {
    VertexKey key{attributes.dump(-1, ' ', false, GltfJson::error_handler_t::replace), {}};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) key.second[3 * i + k] = placement.rows[i][k];
      key.second[9 + i] = placement.offset[i];
    }
    const auto known = vertices_.find(key);
    if (known != vertices_.end()) return known->second;

    const GltfValues positions = attribute(attributes, "POSITION", 3, 3, 0, where);
    const auto base = static_cast<std::uint32_t>(soup_.points.size());
    const std::size_t count = positions.count, end = base + count;
    if (end >= std::numeric_limits<std::uint32_t>::max())
      document_.fail(where, "more vertices than a 32-bit index counts");
    spend(count, where);
    for (std::size_t i = 0; i < count; ++i) {
      const double* p = positions.values.data() + 3 * i;
      const Vec3 q = placement.point(Vec3(p[0], p[1], p[2]));
      if (!std::isfinite(q[0]) || !std::isfinite(q[1]) || !std::isfinite(q[2]))
        document_.fail(where + ".attributes.POSITION", fmt::format("vertex {} is not finite", i));
      soup_.points.push_back(q);
    }
    for (const auto& item : attributes.items()) {
      const std::string& name = item.key();
      if (name == "NORMAL") {
        const GltfValues n = attribute(attributes, "NORMAL", 3, 3, count, where);
        normals_.resize(base, Vec3(nan, nan, nan));
        for (std::size_t i = 0; i < count; ++i)
          normals_.push_back(placement.normal(Vec3(n.values[3 * i], n.values[3 * i + 1], n.values[3 * i + 2])));
      } else if (name == "TEXCOORD_0") {
        const GltfValues t = attribute(attributes, "TEXCOORD_0", 2, 2, count, where);
        textures_.resize(base, {nan, nan});
        // The origin of glTF's is the upper left corner of the picture, of all others the lower left one.
        for (std::size_t i = 0; i < count; ++i) textures_.push_back({t.values[2 * i], 1 - t.values[2 * i + 1]});
      } else if (name == "COLOR_0") {
        colors(attribute(attributes, "COLOR_0", 3, 4, count, where), base);
      } else if (name.starts_with('_') && is_name(name.substr(1)) && is_scalar(item.value())) {
        std::vector<double>& values = soup_.vertex_scalars[name.substr(1)];
        values.resize(base, nan);
        const GltfValues numbers = attribute(attributes, name.c_str(), 1, 1, count, where);
        values.insert(values.end(), numbers.values.begin(), numbers.values.end());
      } else if (name != "POSITION") {
        ++left_["attributes " + name.substr(0, 40)];
      }
    }
    return vertices_[key] = {base, static_cast<std::uint32_t>(count)};
  }

  /// Whether a vertex scalar may be called so in every format.
  static bool is_name(std::string_view name) {
    static constexpr std::string_view taken[] = {"", "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};
    return std::find(std::begin(taken), std::end(taken), name) == std::end(taken) &&
           std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c < 127; });
  }

  bool is_scalar(const GltfJson& index) {
    if (!index.is_number_unsigned()) return false;
    const GltfJson& accessors = document_.list(document_.root(), "accessors", "the file");
    const auto i = index.get<std::uint64_t>();
    return i < accessors.size() && GltfDocument::text(accessors[i], "type") == "SCALAR";
  }

  GltfValues attribute(const GltfJson& attributes, const char* name, std::size_t least, std::size_t most,
                       std::size_t count, const std::string& where) {
    const std::string place = where + ".attributes." + std::string(name).substr(0, 40);
    GltfValues values =
        document_.accessor(document_.integer(attributes, name, where + ".attributes"), least, most, place);
    if (std::string_view(name) != "POSITION" && values.count != count)
      document_.fail(place, fmt::format("has {} values for {} vertices", values.count, count));
    return values;
  }

  void colors(const GltfValues& values, std::size_t base) {
    // Without a colour a vertex is white: what the colour of a vertex multiplies is not changed.
    soup_.vertex_colors.resize(base, {255, 255, 255});
    for (std::size_t i = 0; i < values.count; ++i) {
      std::array<std::uint8_t, 3> color{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double level = 255 * values.values[values.components * i + k];
        const double level_in_range = level >= 0 && level <= 255 ? level : level > 255 ? 255 : 0;
        color[k] = static_cast<std::uint8_t>(std::lround(level_in_range));
        colors_rounded_ += !(std::abs(color[k] - level) < 0.01);
      }
      transparent_ += values.components == 4 && values.values[4 * i + 3] != 1;
      soup_.vertex_colors.push_back(color);
    }
  }

  void finish_attributes() {
    const std::size_t n = soup_.points.size();
    if (!soup_.vertex_colors.empty()) soup_.vertex_colors.resize(n, {255, 255, 255});
    for (auto& [name, values] : soup_.vertex_scalars) values.resize(n, nan);
    if (!normals_.empty()) {
      normals_.resize(n, Vec3(nan, nan, nan));
      if (std::all_of(normals_.begin(), normals_.end(),
                      [](const Vec3& v) { return std::isfinite(v[0] + v[1] + v[2]); }))
        soup_.vertex_normals = std::move(normals_);
      else
        note("normals are not kept: not all vertices have one");
    }
    if (textures_.empty()) return;
    textures_.resize(n, {nan, nan});
    std::vector<double>&s = soup_.corner_scalars["s"], &t = soup_.corner_scalars["t"];
    for (const Triangle& triangle : soup_.triangles)
      for (const std::uint32_t v : triangle) s.push_back(textures_[v][0]), t.push_back(textures_[v][1]);
  }

  void finish_notes() {
    if (!soup_.points.empty()) note("glTF is in metres: coordinates were converted to millimetres");
    if (mirrored_ > 0)
      note(fmt::format("{} primitives are mirrored by their transform: their triangles were reversed", mirrored_));
    if (colors_rounded_ > 0) note(fmt::format("{} colour values were rounded to 8 bits", colors_rounded_));
    if (transparent_ > 0) note(fmt::format("the transparency of {} vertices is not kept", transparent_));
    for (const char* name : {"images", "textures", "animations"})
      if (const GltfJson& all = document_.list(document_.root(), name, "the file"); !all.empty())
        left_[name] += all.size();
    std::uint64_t looks = 0;
    for (const GltfJson& material : document_.list(document_.root(), "materials", "the file"))
      looks += material.is_object() && (material.size() > material.contains("name"));
    if (looks > 0) note(fmt::format("of {} materials only the names are kept", looks));
    std::string list;
    for (const auto& [what, count] : left_) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, what);
    if (!list.empty()) note("what has no place in a triangle mesh is not kept: " + list);
  }

  void note(std::string text) { info_.notes.push_back(std::move(text)); }

  GltfDocument document_;
  Context& context_;
  MeshFileInfo& info_;
  std::size_t budget_;
  Soup soup_;
  std::set<std::uint64_t> visited_;
  std::map<VertexKey, std::pair<std::uint32_t, std::uint32_t>> vertices_;
  std::vector<Vec3> normals_;
  std::vector<std::array<double, 2>> textures_;
  PartLabels objects_{"object"}, materials_{"material"};
  std::map<std::string, std::uint64_t> left_;
  std::uint64_t mirrored_ = 0, colors_rounded_ = 0, transparent_ = 0;
  bool named_ = false;
};

}  // namespace

bool looks_like_gltf(std::string_view bytes) {
  if (bytes.starts_with("glTF")) return true;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != bytes.npos && bytes[first] == '{' &&
         bytes.substr(0, std::min<std::size_t>(bytes.size(), 1 << 16)).find("\"asset\"") != bytes.npos;
}

Soup parse_gltf(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info) {
  info.format = MeshFormat::gltf;
  return SceneReader(bytes, file, context, info).run();
}

}  // namespace tri::io_detail
