#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "io/mesh_formats/base64.hpp"
#include "io/mesh_formats/float_rounding.hpp"
#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/part_runs.hpp"
#include "meshops/error.hpp"

// "glTF 2.0 Specification", The Khronos Group, 2021. Coordinates stay in millimetres, as floats; a node with a scale of
// 0.001 makes them the metres of the standard. So what was floats in millimetres before (binary STL) is not rounded.
namespace tri::io_detail {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little endian");

using Json = nlohmann::ordered_json;

constexpr int float_type = 5126, byte_type = 5121, index_type = 5125;
constexpr std::size_t most_primitives = 10'000;

class GltfWriter {
 public:
  GltfWriter(const Soup& soup, Context& context, MeshWriteReport& report)
      : soup_(soup), context_(context), report_(report) {}

  /// @return the JSON; the bytes of its one buffer are in `bytes`
  Json run() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "tri"}};
    json_["scene"] = 0;
    note_rounding_to_floats(soup_, "glTF", report_);
    split_at_seams();
    if (!soup_.triangles.empty())
      scene(attributes());
    else
      json_["scenes"] = Json::array({Json::object()});
    if (!bytes.empty()) json_["buffers"] = {{{"byteLength", bytes.size()}}};
    return std::move(json_);
  }

  std::string bytes;

 private:
  /// A vertex of glTF has one texture coordinate: where corners at a vertex differ, it is doubled.
  void split_at_seams() {
    source_.resize(soup_.points.size());
    for (std::size_t i = 0; i < source_.size(); ++i) source_[i] = static_cast<std::uint32_t>(i);
    for (const Triangle& t : soup_.triangles) corners_.insert(corners_.end(), t.begin(), t.end());
    const auto s = soup_.corner_scalars.find("s"), t = soup_.corner_scalars.find("t");
    if (s == soup_.corner_scalars.end() || t == soup_.corner_scalars.end()) return;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (std::isfinite(s->second[i]) && std::isfinite(t->second[i])) continue;
      report_.notes.emplace_back(
          "texture coordinates were not written: not every corner has them, and glTF holds only finite ones");
      return;
    }
    using Place = std::array<double, 2>;
    std::vector<Place> first(source_.size());
    std::vector<char> seen(source_.size(), 0);
    std::map<std::pair<std::uint32_t, Place>, std::uint32_t> copies;
    textures_.assign(source_.size(), {0, 0});
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Place place{s->second[i], t->second[i]};
      std::uint32_t& v = corners_[i];
      if (!seen[v]) {
        seen[v] = 1;
        first[v] = textures_[v] = place;
      } else if (first[v] != place) {
        const auto [found, is_new] = copies.try_emplace({v, place}, static_cast<std::uint32_t>(source_.size()));
        if (is_new) {
          source_.push_back(v);
          textures_.push_back(place);
        }
        v = found->second;
      }
    }
    if (!copies.empty())
      report_.notes.push_back(
          fmt::format("{} vertices were doubled: glTF holds one texture coordinate for each", copies.size()));
  }

  template <class Value>
  void put(Value value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  /// @return number of the view of the bytes from `begin` on
  std::size_t view(std::size_t begin, int target) {
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size() - begin}, {"target", target}});
    return json_["bufferViews"].size() - 1;
  }

  std::size_t accessor(std::size_t view, std::size_t offset, int component, std::size_t count, const char* type) {
    json_["accessors"].push_back(
        {{"bufferView", view}, {"byteOffset", offset}, {"componentType", component}, {"count", count}, {"type", type}});
    return json_["accessors"].size() - 1;
  }

  /// Puts floats, one row for each vertex, and counts those that were rounded. @param row of a vertex of the soup
  template <class Row>
  std::size_t floats(const char* what, const char* type, const Row& row) {
    context_.checkpoint();
    const std::size_t begin = bytes.size();
    bool rounded = false;
    for (std::size_t i = 0; i < source_.size(); ++i)
      for (const double value : row(i)) {
        const auto shorter = static_cast<float>(value);
        rounded = rounded || static_cast<double>(shorter) != value;
        put(shorter);
      }
    if (rounded && *what) rounded_ += (rounded_.empty() ? "" : ", ") + std::string(what);
    return accessor(view(begin, 34962), 0, float_type, source_.size(), type);
  }

  Json attributes() {
    Json result;
    result["POSITION"] = floats("", "VEC3", [&](std::size_t i) { return soup_.points[source_[i]]; });
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (const Vec3& p : soup_.points)
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], static_cast<float>(p[k]));
        high[k] = std::max(high[k], static_cast<float>(p[k]));
      }
    json_["accessors"].back()["min"] = low;
    json_["accessors"].back()["max"] = high;
    if (!soup_.vertex_normals.empty())
      result["NORMAL"] = floats("normals", "VEC3", [&](std::size_t i) { return soup_.vertex_normals[source_[i]]; });
    if (!textures_.empty())
      // The origin of glTF's is the upper left corner of the picture, of all others the lower left one.
      result["TEXCOORD_0"] = floats("texture coordinates", "VEC2", [&](std::size_t i) {
        return std::array<double, 2>{textures_[i][0], 1 - textures_[i][1]};
      });
    if (!soup_.vertex_colors.empty()) {
      const std::size_t begin = bytes.size();
      for (const std::uint32_t v : source_) {
        const auto& c = soup_.vertex_colors[v];
        put(std::array<std::uint8_t, 4>{c[0], c[1], c[2], 255});
      }
      result["COLOR_0"] = accessor(view(begin, 34962), 0, byte_type, source_.size(), "VEC4");
      json_["accessors"].back()["normalized"] = true;
    }
    scalars(result);
    if (!rounded_.empty()) report_.notes.push_back("rounded to the floats of glTF: " + rounded_);
    return result;
  }

  /// Vertex scalars as attributes of an application, whose names begin with an underscore.
  void scalars(Json& result) {
    std::string lost;
    for (const auto& [name, values] : soup_.vertex_scalars) {
      const double most = static_cast<double>(std::numeric_limits<float>::max());
      if (std::all_of(values.begin(), values.end(), [most](double v) { return std::abs(v) <= most; }))
        result["_" + name] = floats(name.c_str(), "SCALAR", [&, &list = values](std::size_t i) {
          return std::array<double, 1>{list[source_[i]]};
        });
      else
        lost += (lost.empty() ? "" : ", ") + name;
    }
    if (!lost.empty())
      report_.notes.push_back("vertex scalars that are not finite floats everywhere were not written: " + lost);
  }

  std::size_t material(const std::string& name) {
    const auto [found, is_new] = materials_.try_emplace(name, materials_.size());
    if (is_new) json_["materials"].push_back({{"name", name}});
    return found->second;
  }

  /// One node for each object and one primitive for each material in it; all share the vertices.
  void scene(const Json& attributes) {
    std::vector<PartRun> objects = part_runs(soup_, "object"), materials = part_runs(soup_, "material");
    if (objects.size() + materials.size() > most_primitives) {
      report_.notes.push_back(fmt::format(
          "objects and materials change more than {} times from triangle to triangle: they were not written",
          most_primitives));
      objects = materials = {{0, soup_.triangles.size(), -1}};
    }
    const std::size_t begin = bytes.size();
    for (const std::uint32_t v : corners_) put(v);
    const std::size_t indices = view(begin, 34963);
    Json children = Json::array();
    json_["nodes"] = Json::array({Json::object()});
    std::size_t m = 0;
    for (const PartRun& object : objects) {
      Json primitives = Json::array();
      for (std::size_t at = object.begin; at < object.end;) {
        while (materials[m].end <= at) ++m;
        const std::size_t end = std::min(materials[m].end, object.end);
        primitives.push_back({{"attributes", attributes},
                              {"indices", accessor(indices, 12 * at, index_type, 3 * (end - at), "SCALAR")}});
        if (const std::string* name = label_name(soup_, "material", materials[m].label))
          primitives.back()["material"] = material(*name);
        at = end;
      }
      json_["meshes"].push_back({{"primitives", primitives}});
      Json node{{"mesh", json_["meshes"].size() - 1}};
      if (const std::string* name = label_name(soup_, "object", object.label)) node["name"] = *name;
      children.push_back(json_["nodes"].size());
      json_["nodes"].push_back(node);
    }
    json_["nodes"][0] = {{"scale", {0.001, 0.001, 0.001}}, {"children", children}};
    json_["scenes"] = {{{"nodes", {0}}}};
  }

  const Soup& soup_;
  Context& context_;
  MeshWriteReport& report_;
  Json json_;
  std::vector<std::uint32_t> source_;   // of each vertex that is written: the one of the soup
  std::vector<std::uint32_t> corners_;  // of triangles: vertices that are written
  std::vector<std::array<double, 2>> textures_;
  std::map<std::string, std::size_t> materials_;
  std::string rounded_;
};

std::string compact_text(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void put_chunk(AtomicFile& file, std::uint32_t type, const std::string& content) {
  file.write_value(static_cast<std::uint32_t>(content.size()));
  file.write_value(type);
  file.write(content);
}

}  // namespace

void write_gltf(AtomicFile& file, const Soup& soup, bool binary, Context& context, MeshWriteReport& report) {
  GltfWriter writer(soup, context, report);
  Json json = writer.run();
  std::string& bytes = writer.bytes;
  if (!binary) {
    if (!bytes.empty()) json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + to_base64(bytes);
    file.write(compact_text(json));
    return;
  }
  std::string text = compact_text(json);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
  const std::size_t size = 12 + 8 + text.size() + (bytes.empty() ? 0 : 8 + bytes.size());
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("a GLB file counts its bytes in 32 bits: this mesh is too large for it");
  file.write("glTF");
  file.write_value(std::uint32_t{2});
  file.write_value(static_cast<std::uint32_t>(size));
  put_chunk(file, 0x4E4F534A, text);
  if (!bytes.empty()) put_chunk(file, 0x004E4942, bytes);
}

}  // namespace tri::io_detail
