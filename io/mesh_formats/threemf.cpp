#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/input_file.hpp"
#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/part_labels.hpp"
#include "io/mesh_formats/threemf_model.hpp"
#include "meshops/error.hpp"

namespace tri::io_detail {
namespace {

/// Puts the objects of the build, and what they are made of, into one soup.
class Assembler {
 public:
  Assembler(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info)
      : archive_(bytes, file), file_(file), context_(context), info_(info) {}

  Soup run() {
    const std::string start = threemf_start_part(archive_, file_);
    if (!archive_.has(start)) throw IoError(file_, fmt::format("is an archive without a 3D model (no part {})", start));
    const ThreemfModel& root = model(start);
    const Placement unit = Placement::scaled(root.unit);
    for (const ThreemfComponent& item : root.items) place(item, start, unit * item.placement, 0);
    if (root.items.empty()) {
      // Against the specification, but found: without a list of what to build, every object is meant.
      for (const auto& [number, object] : root.objects)
        if (!object.triangles.empty()) place({number, "", {}}, start, unit, 0);
      if (!root.objects.empty())
        info_.notes.emplace_back("there is no list of what to build: every object with triangles was taken");
    }
    finish_notes(root);
    finish_colors();
    info_.polygons = soup_.triangles.size();
    for (const std::string& name : objects_.names()) info_.parts.push_back(name);
    if (info_.parts.empty()) info_.parts.emplace_back();
    if (instances_ > 1 || named_) std::move(objects_).finish(soup_);
    std::move(materials_).finish(soup_);
    return std::move(soup_);
  }

 private:
  const ThreemfModel& model(const std::string& part) {
    const auto found = models_.find(part);
    if (found != models_.end()) return found->second;
    ThreemfModel read = parse_threemf_model(archive_, part, file_, context_);
    for (const auto& [number, object] : read.objects) elements_ += object.points.size() + object.triangles.size();
    return models_.emplace(part, std::move(read)).first->second;
  }

  void place(const ThreemfComponent& what, const std::string& from, const Placement& placement, int depth) {
    context_.checkpoint();
    const std::string part = what.part.empty() ? from : what.part.substr(what.part.starts_with('/') ? 1 : 0);
    if (depth > 64)
      throw IoError(file_, fmt::format("object {} of {}: components within components deeper than 64, or without end",
                                       what.object, part));
    const ThreemfModel& source = model(part);
    const auto found = source.objects.find(what.object);
    if (found == source.objects.end())
      throw IoError(file_, fmt::format("{} has no object {}, which is placed", part, what.object));
    const ThreemfObject& object = found->second;
    placed_ += 1 + object.points.size() + object.triangles.size();
    if (placed_ > instance_budget(info_.bytes) + elements_)
      throw IoError(
          file_,
          fmt::format("object {} of {}: copies of copies come to more than {} elements, absurd for a file of {} bytes",
                      what.object, part, placed_, info_.bytes));
    if (soup_.points.size() + object.points.size() >= std::numeric_limits<std::uint32_t>::max())
      throw IoError(file_, "more vertices than a 32-bit index counts");
    if (!object.triangles.empty() || !object.points.empty()) append(object, source, placement, what.object, part);
    for (const ThreemfComponent& component : object.components)
      place(component, part, placement * component.placement, depth + 1);
  }

  void append(const ThreemfObject& object, const ThreemfModel& source, const Placement& placement, std::uint32_t number,
              const std::string& part) {
    ++instances_;
    named_ = named_ || !object.name.empty();
    const auto base = static_cast<std::uint32_t>(soup_.points.size());
    for (const Vec3& p : object.points) {
      const Vec3 q = placement.point(p);
      if (!std::isfinite(q[0]) || !std::isfinite(q[1]) || !std::isfinite(q[2]))
        throw IoError(file_, fmt::format("object {} of {}: its transform takes vertex {} beyond all numbers", number,
                                         part, soup_.points.size() - base));
      soup_.points.push_back(q);
    }
    const bool mirrored = placement.determinant() < 0;
    mirrored_ += mirrored;
    for (std::size_t i = 0; i < object.triangles.size(); ++i) {
      const Triangle& t = object.triangles[i];
      const std::array<std::size_t, 3> order =
          mirrored ? std::array<std::size_t, 3>{0, 2, 1} : std::array<std::size_t, 3>{0, 1, 2};
      soup_.triangles.push_back({base + t[order[0]], base + t[order[1]], base + t[order[2]]});
      add_property(object.properties.empty() ? ThreemfProperty{} : object.properties[i], source, order, number, part,
                   i);
    }
    objects_.fill(soup_.triangles.size(),
                  objects_.own_label(object.name.empty() ? fmt::format("object {}", number) : object.name));
  }

  void add_property(const ThreemfProperty& property, const ThreemfModel& source,
                    const std::array<std::size_t, 3>& order, std::uint32_t number, const std::string& part,
                    std::size_t triangle) {
    double material = -1;
    const auto list = property.list ? source.colors.find(property.list) : source.colors.end();
    if (list != source.colors.end()) {
      const ThreemfColors& colors = list->second;
      colors_.resize(3 * (soup_.triangles.size() - 1));
      for (const std::size_t k : order) {
        const std::uint32_t entry = property.entry[colors.materials ? 0 : k];  // of base materials the first counts
        if (entry >= colors.colors.size())
          throw IoError(file_, fmt::format("{}: triangle {} of object {} names entry {} of the {} of resource {}", part,
                                           triangle, number, entry, colors.colors.size(), property.list));
        colors_.push_back({true, colors.colors[entry]});
      }
      if (colors.materials) {
        material = materials_.label(colors.names[property.entry[0]]);
        corner_colors_only_ = false;
      }
    } else if (property.list) {
      ++other_properties_;
    }
    materials_.fill(soup_.triangles.size(), material);
  }

  /// Colours of corners become colours of vertices if each has one, else of triangles if each has one, else of corners.
  /// Those of base materials are of triangles.
  void finish_colors() {
    if (colors_.empty()) return;
    colors_.resize(3 * soup_.triangles.size());
    if (corner_colors_only_ && colors_at_vertices()) return;
    bool uniform = true;
    for (std::size_t i = 0; i < colors_.size(); i += 3)
      uniform = uniform && colors_[i] == colors_[i + 1] && colors_[i] == colors_[i + 2];
    static constexpr const char* names[] = {"red", "green", "blue"};
    for (std::size_t c = 0; c < 3; ++c) {
      std::vector<double>& values = (uniform ? soup_.face_scalars : soup_.corner_scalars)[names[c]];
      for (std::size_t i = 0; i < colors_.size(); i += uniform ? 3 : 1)
        values.push_back(colors_[i].known ? colors_[i].rgb[c] : std::numeric_limits<double>::quiet_NaN());
    }
  }

  bool colors_at_vertices() {
    std::vector<Color> of_vertex(soup_.points.size());
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      Color& color = of_vertex[soup_.triangles[i / 3][i % 3]];
      if (!colors_[i].known || (color.known && color != colors_[i])) return false;
      color = colors_[i];
    }
    if (!std::all_of(of_vertex.begin(), of_vertex.end(), [](const Color& c) { return c.known; })) return false;
    for (const Color& c : of_vertex) soup_.vertex_colors.push_back(c.rgb);
    return true;
  }

  void finish_notes(const ThreemfModel& root) {
    if (root.unit != 1)
      info_.notes.push_back(
          fmt::format("the unit of the file is the {}: coordinates were multiplied by {} to millimetres",
                      root.unit_name, root.unit));
    if (mirrored_ > 0)
      info_.notes.push_back(
          fmt::format("{} objects are mirrored by their transform: their triangles were reversed", mirrored_));
    if (other_properties_ > 0)
      info_.notes.push_back(
          fmt::format("the properties of {} triangles (textures, mixtures …) are not kept", other_properties_));
    std::uint64_t transparent = 0;
    std::map<std::string, std::uint64_t> left;
    for (const auto& [part, read] : models_) {
      transparent += read.transparent;
      for (const auto& [name, count] : read.left) left[name] += count;
    }
    if (transparent > 0) info_.notes.push_back(fmt::format("the transparency of {} colours is not kept", transparent));
    std::string list;
    for (const auto& [name, count] : left) list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, name);
    if (!list.empty()) info_.notes.push_back("what has no place in a triangle mesh is not kept: " + list);
    std::uint64_t pictures = 0;
    for (const std::string& name : archive_.names()) {
      const std::string extension = file_extension(name);
      pictures += extension == "png" || extension == "jpg" || extension == "jpeg";
    }
    if (pictures > 0) info_.notes.push_back(fmt::format("{} pictures (thumbnails, textures) are not kept", pictures));
  }

  struct Color {
    bool known = false;
    Rgb rgb{};
    friend bool operator==(const Color&, const Color&) = default;
  };

  ZipArchive archive_;
  const std::string& file_;
  Context& context_;
  MeshFileInfo& info_;
  std::map<std::string, ThreemfModel> models_;
  Soup soup_;
  PartLabels objects_{"object"}, materials_{"material"};
  std::vector<Color> colors_;  // of corners; empty without
  bool corner_colors_only_ = true, named_ = false;
  std::uint64_t instances_ = 0, mirrored_ = 0, other_properties_ = 0;
  std::size_t elements_ = 0, placed_ = 0;
};

}  // namespace

Soup parse_threemf(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info) {
  info.format = MeshFormat::threemf;
  info.encoding = MeshEncoding::compressed_text;
  return Assembler(bytes, file, context, info).run();
}

}  // namespace tri::io_detail
