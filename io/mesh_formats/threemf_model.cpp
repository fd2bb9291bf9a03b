#include "io/mesh_formats/threemf_model.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/xml_stream.hpp"
#include "io/text_scanner.hpp"

namespace tri::io_detail {
namespace {

constexpr std::string_view core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
constexpr std::string_view materials = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

class ModelReader {
 public:
  ModelReader(const std::string& file, const std::string& part, Context& context)
      : context_(context),
        xml_(
            file, part,
            [this](std::string_view space, std::string_view name, const XmlAttributes& a) { start(space, name, a); },
            [this](std::string_view name) { end(name); }) {}

  ThreemfModel run(const ZipArchive& archive, const std::string& part) {
    archive.read(part, [this](std::string_view piece) {
      context_.checkpoint();
      xml_.feed(piece, false);
    });
    xml_.feed({}, true);
    if (!model_seen_) xml_.fail("the root element is no 3MF model");
    return std::move(model_);
  }

 private:
  void start(std::string_view space, std::string_view name, const XmlAttributes& a) {
    if (skipped_ > 0) {
      ++skipped_;
      return;
    }
    if (space == materials && (name == "colorgroup" || name == "color"))
      color_group(name, a);
    else if (space != core)
      leave(name);
    else if (name == "vertex")
      vertex(a);
    else if (name == "triangle")
      triangle(a);
    else
      structure(name, a);
  }

  void end(std::string_view name) {
    if (skipped_ > 0) {
      --skipped_;
      return;
    }
    if (name == "object" && object_) {
      check_triangles();
      object_ = nullptr;
    } else if (name == "basematerials" || name == "colorgroup") {
      list_ = nullptr;
    }
  }

  /// An element that has no place in a mesh, with all that is in it.
  void leave(std::string_view name) {
    if (model_.left.size() < 20 || model_.left.contains(std::string(name))) ++model_.left[std::string(name)];
    skipped_ = 1;
  }

  void structure(std::string_view name, const XmlAttributes& a) {
    if (name == "model") {
      model_seen_ = true;
      if (const char* unit = a.find("unit")) set_unit(unit);
      if (const char* required = a.find("requiredextensions"))
        for (const char* word : {"s", "b", "sc", "i"})
          if (fmt::format(" {} ", required).find(fmt::format(" {} ", word)) != std::string::npos)
            ++model_.left["requiredextensions " + std::string(word)];
    } else if (name == "object") {
      object(a);
    } else if (name == "component" || name == "item") {
      place(name, a);
    } else if (name == "basematerials") {
      list_ = &model_.colors[id(a, "id")];
      *list_ = {};
      list_->materials = true;
    } else if (name == "base") {
      if (!list_) xml_.fail("a base outside of basematerials");
      list_->colors.push_back(color(a.find("displaycolor")));
      const char* title = a.find("name");
      list_->names.emplace_back(title ? title : "");
    } else if (name != "resources" && name != "build" && name != "mesh" && name != "vertices" && name != "triangles" &&
               name != "components") {
      // Titles, dates and the like are about the file, not about the mesh.
      if (name == "metadata" || name == "metadatagroup")
        skipped_ = 1;
      else
        leave(name);
    }
  }

  void set_unit(std::string_view unit) {
    static constexpr std::pair<std::string_view, double> units[] = {
        {"micron", 0.001}, {"millimeter", 1}, {"centimeter", 10}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1000}};
    for (const auto& [name, size] : units) {
      if (name != unit) continue;
      model_.unit = size;
      model_.unit_name = name;
      return;
    }
    xml_.fail("unknown unit " + io_detail::quoted(unit));
  }

  std::uint32_t number(const char* text, const char* what) {
    std::uint32_t value = 0;
    const std::string_view digits(text ? text : "");
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (digits.empty() || result.ec != std::errc() || result.ptr != digits.data() + digits.size())
      xml_.fail(text ? fmt::format("{} is {}, which is no index", what, io_detail::quoted(digits))
                     : fmt::format("there is no {}", what));
    return value;
  }
  std::uint32_t id(const XmlAttributes& a, const char* name) {
    const std::uint32_t value = number(a.find(name), name);
    if (value == 0) xml_.fail(fmt::format("{} is 0", name));
    return value;
  }

  double coordinate(const XmlAttributes& a, const char* name) {
    const char* text = a.find(name);
    double value = 0;
    if (!text) xml_.fail(fmt::format("a vertex without {}", name));
    if (!parse_number(text, value))
      xml_.fail(fmt::format("{} is {}, which is no number", name, io_detail::quoted(text)));
    if (!std::isfinite(value)) xml_.fail(fmt::format("{} is {}, which is not finite", name, io_detail::quoted(text)));
    return value;
  }

  void object(const XmlAttributes& a) {
    const std::uint32_t number = id(a, "id");
    if (model_.objects.contains(number)) xml_.fail(fmt::format("there are two objects {}", number));
    object_ = &model_.objects[number];
    const char* name = a.find("name");
    object_->name = name ? name : "";
    own_ = {};
    if (const char* list = a.find("pid")) {
      own_.list = this->number(list, "pid");
      const char* entry = a.find("pindex");
      own_.entry.fill(entry ? this->number(entry, "pindex") : 0);
    }
  }

  void vertex(const XmlAttributes& a) {
    if (!object_) xml_.fail("a vertex outside of an object");
    if (object_->points.size() >= std::numeric_limits<std::uint32_t>::max())
      xml_.fail("more vertices than a 32-bit index counts");
    const double x = coordinate(a, "x"), y = coordinate(a, "y"), z = coordinate(a, "z");
    object_->points.emplace_back(x, y, z);
  }

  void triangle(const XmlAttributes& a) {
    if (!object_) xml_.fail("a triangle outside of an object");
    Triangle corners{};
    static constexpr const char* names[] = {"v1", "v2", "v3"};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = number(a.find(names[k]), names[k]);
      // Vertices come first, so that the place can be named at once.
      if (corners[k] >= object_->points.size())
        xml_.fail(
            fmt::format("{} is {}, but the object has {} vertices", names[k], corners[k], object_->points.size()));
    }
    ThreemfProperty property = own_;
    if (const char* list = a.find("pid")) property = {number(list, "pid"), {}};
    if (const char* first = a.find("p1"); first && property.list) {
      property.entry.fill(number(first, "p1"));
      if (const char* second = a.find("p2")) property.entry[1] = number(second, "p2");
      if (const char* third = a.find("p3")) property.entry[2] = number(third, "p3");
    }
    object_->triangles.push_back(corners);
    if (property.list || !object_->properties.empty()) {
      object_->properties.resize(object_->triangles.size() - 1);
      object_->properties.push_back(property);
    }
  }

  void check_triangles() {
    if (!object_->triangles.empty() && !object_->components.empty())
      xml_.fail("an object with a mesh and with components");
    if (!object_->properties.empty()) object_->properties.resize(object_->triangles.size());
  }

  void place(std::string_view name, const XmlAttributes& a) {
    ThreemfComponent component;
    component.object = id(a, "objectid");
    if (const char* part = a.find("path", true)) component.part = part;
    if (const char* text = a.find("transform")) component.placement = transform(text);
    if (name == "item")
      model_.items.push_back(std::move(component));
    else if (!object_)
      xml_.fail("a component outside of an object");
    else
      object_->components.push_back(std::move(component));
  }

  /// Twelve numbers, the rows of a 4 x 3 matrix that is multiplied from the right.
  Placement transform(const char* text) {
    const std::string_view all(text);
    std::array<double, 12> m{};
    std::size_t count = 0, at = 0;
    while (true) {
      at = std::min(all.find_first_not_of(" \t\r\n", at), all.size());
      if (at == all.size()) break;
      const std::size_t end = std::min(all.find_first_of(" \t\r\n", at), all.size());
      double value = 0;
      if (count == 12 || !parse_number(all.substr(at, end - at), value) || !std::isfinite(value))
        xml_.fail(fmt::format("the transform {} is not of 12 finite numbers", io_detail::quoted(all)));
      m[count++] = value;
      at = end;
    }
    if (count != 12) xml_.fail(fmt::format("the transform {} is not of 12 finite numbers", io_detail::quoted(all)));
    Placement placement;
    for (std::size_t i = 0; i < 3; ++i) {
      placement.rows[i] = Vec3(m[i], m[3 + i], m[6 + i]);
      placement.offset[i] = m[9 + i];
    }
    return placement;
  }

  void color_group(std::string_view name, const XmlAttributes& a) {
    if (name == "colorgroup") {
      list_ = &model_.colors[id(a, "id")];
      *list_ = {};
    } else {
      if (!list_) xml_.fail("a color outside of a colorgroup");
      list_->colors.push_back(color(a.find("color")));
    }
  }

  /// "#RRGGBB" or "#RRGGBBAA".
  Rgb color(const char* text) {
    const std::string_view all(text ? text : "");
    std::uint32_t value = 0;
    const bool sized = all.size() == 7 || all.size() == 9;
    const auto result =
        sized ? std::from_chars(all.data() + 1, all.data() + all.size(), value, 16) : std::from_chars_result{};
    if (!sized || all[0] != '#' || result.ec != std::errc() || result.ptr != all.data() + all.size())
      xml_.fail(fmt::format("the colour {} is not #RRGGBB or #RRGGBBAA", io_detail::quoted(all)));
    if (all.size() == 9) {
      model_.transparent += (value & 0xFF) != 0xFF;
      value >>= 8;
    }
    return {static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
            static_cast<std::uint8_t>(value)};
  }

  Context& context_;
  ThreemfModel model_;
  ThreemfObject* object_ = nullptr;
  ThreemfColors* list_ = nullptr;
  ThreemfProperty own_;      // of the object, for triangles that name none
  std::size_t skipped_ = 0;  // depth within an element that is left out
  bool model_seen_ = false;
  XmlStream xml_;
};

}  // namespace

ThreemfModel parse_threemf_model(const ZipArchive& archive, const std::string& part, const std::string& file,
                                 Context& context) {
  return ModelReader(file, part, context).run(archive, part);
}

std::string threemf_start_part(const ZipArchive& archive, const std::string& file) {
  std::string target;
  if (archive.has("_rels/.rels")) {
    XmlStream xml(
        file, "_rels/.rels",
        [&](std::string_view, std::string_view name, const XmlAttributes& a) {
          const char *type = a.find("Type"), *to = a.find("Target");
          if (name == "Relationship" && target.empty() && type && to && std::string_view(type).ends_with("/3dmodel"))
            target = to;
        },
        [](std::string_view) {});
    archive.read("_rels/.rels", [&](std::string_view piece) { xml.feed(piece, false); });
    xml.feed({}, true);
  }
  if (target.empty()) target = "3D/3dmodel.model";
  return target.starts_with('/') ? target.substr(1) : target;
}

}  // namespace tri::io_detail
