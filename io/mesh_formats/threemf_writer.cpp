#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/part_runs.hpp"
#include "io/mesh_formats/zip_archive.hpp"
#include "io/pictures/face_color.hpp"
#include "io/xml_text.hpp"
#include "meshops/soup_edit.hpp"

namespace tri::io_detail {
namespace {

constexpr const char* content_types =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr const char* relationships =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";

class ModelWriter {
 public:
  ModelWriter(const Soup& soup, Context& context, MeshWriteReport& report)
      : soup_(soup), context_(context), report_(report) {}

  std::string run() {
    out_ =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<model unit=\"millimeter\" xml:lang=\"en-US\" "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" "
        "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n"
        "<metadata name=\"Application\">tri</metadata>\n<resources>\n";
    colors();
    std::vector<PartRun> runs = part_runs(soup_, "object");
    std::vector<std::size_t> first_vertex;
    if (!separate_parts(soup_, runs, first_vertex)) {
      report_.notes.emplace_back(
          "the objects share vertices or are mixed: 3MF holds them as one object, without their names");
      runs = {{0, soup_.triangles.size(), -1}};
      first_vertex = {0};
    }
    if (runs.empty()) runs.push_back({0, 0, -1});
    first_vertex.push_back(soup_.points.size());
    for (std::size_t r = 0; r < runs.size(); ++r) object(r, runs[r], first_vertex[r], first_vertex[r + 1]);
    out_ += "</resources>\n<build>\n";
    for (std::size_t r = 0; r < runs.size(); ++r) out_ += fmt::format("<item objectid=\"{}\"/>\n", first_object + r);
    out_ += "</build>\n</model>\n";
    if (repeated_ > 0)
      report_.notes.push_back(
          fmt::format("3MF holds no triangle that names a vertex twice: {} were not written", repeated_));
    return std::move(out_);
  }

 private:
  static constexpr std::size_t color_list = 1, first_object = 2;

  template <class Number>
  void put(Number value) {
    char text[32];
    out_.append(text, std::to_chars(text, text + sizeof text, value).ptr);
  }

  static std::string hex(const std::array<std::uint8_t, 3>& c) {
    return fmt::format("#{:02X}{:02X}{:02X}", c[0], c[1], c[2]);
  }

  /// One list of colours: a group with those of vertices, else base materials with those of triangles.
  void colors() {
    if (!soup_.vertex_colors.empty()) {
      out_ += "<m:colorgroup id=\"1\">\n";
      std::map<std::array<std::uint8_t, 3>, std::int64_t> numbers;
      for (const auto& color : soup_.vertex_colors) {
        const auto [found, is_new] = numbers.try_emplace(color, static_cast<std::int64_t>(numbers.size()));
        if (is_new) out_ += fmt::format("<m:color color=\"{}\"/>\n", hex(color));
        entry_.push_back(found->second);
      }
      out_ += "</m:colorgroup>\n";
      return;
    }
    entry_.assign(soup_.triangles.size(), -1);
    const bool colored = has_face_colors(soup_);
    const auto materials = soup_.face_scalars.find("material");
    std::map<std::pair<std::string, std::string>, std::size_t> numbers;  // of name and colour
    std::string list;
    for (std::size_t i = 0; i < soup_.triangles.size(); ++i) {
      const std::string* name =
          materials == soup_.face_scalars.end() ? nullptr : label_name(soup_, "material", materials->second[i]);
      std::array<std::uint8_t, 3> color{};
      const bool has_color = colored && face_color(soup_, i, color);
      if (!name && !has_color) continue;
      // A base material cannot do without a colour.
      const std::string shown = has_color ? hex(color) : "#808080";
      const auto [found, is_new] = numbers.try_emplace({name ? *name : shown, shown}, numbers.size());
      if (is_new) list += fmt::format("<base name=\"{}\" displaycolor=\"{}\"/>\n", xml_text(found->first.first), shown);
      entry_[i] = static_cast<std::int64_t>(found->second);
    }
    if (!list.empty()) out_ += "<basematerials id=\"1\">\n" + list + "</basematerials>\n";
  }

  void object(std::size_t number, const PartRun& run, std::size_t begin, std::size_t end) {
    out_ += fmt::format("<object id=\"{}\" type=\"model\"", first_object + number);
    if (const std::string* name = label_name(soup_, "object", run.label))
      out_ += fmt::format(" name=\"{}\"", xml_text(*name));
    if (run.begin < run.end && all_have_properties(run)) out_ += " pid=\"1\" pindex=\"0\"";
    out_ += ">\n<mesh>\n<vertices>\n";
    for (std::size_t i = begin; i < end; ++i) {
      if (i % checkpoint_interval == 0) context_.checkpoint();
      static constexpr const char* names[] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
      for (std::size_t k = 0; k < 3; ++k) out_ += names[k], put(soup_.points[i][k]);
      out_ += "\"/>\n";
    }
    out_ += "</vertices>\n<triangles>\n";
    for (std::size_t i = run.begin; i < run.end; ++i) {
      if (i % checkpoint_interval == 0) {
        context_.checkpoint();
        context_.progress("write", static_cast<double>(i) / static_cast<double>(soup_.triangles.size()));
      }
      const Triangle& t = soup_.triangles[i];
      if (repeats_vertex(t)) {
        ++repeated_;
        continue;
      }
      static constexpr const char* names[] = {"<triangle v1=\"", "\" v2=\"", "\" v3=\""};
      for (std::size_t k = 0; k < 3; ++k) out_ += names[k], put(t[k] - begin);
      property(i);
      out_ += "\"/>\n";
    }
    out_ += "</triangles>\n</mesh>\n</object>\n";
  }

  /// Then the object has to name one as well, by the specification; what it names would fall to triangles without one.
  bool all_have_properties(const PartRun& run) const {
    if (!soup_.vertex_colors.empty()) return true;
    const auto begin = entry_.begin() + static_cast<std::ptrdiff_t>(run.begin);
    return std::all_of(begin, begin + static_cast<std::ptrdiff_t>(run.end - run.begin),
                       [](std::int64_t e) { return e >= 0; });
  }

  void property(std::size_t triangle) {
    if (!soup_.vertex_colors.empty()) {
      static constexpr const char* names[] = {"\" pid=\"1\" p1=\"", "\" p2=\"", "\" p3=\""};
      for (std::size_t k = 0; k < 3; ++k) {
        out_ += names[k];
        put(entry_[soup_.triangles[triangle][k]]);
      }
    } else if (entry_[triangle] >= 0) {
      out_ += "\" pid=\"1\" p1=\"";
      put(entry_[triangle]);
    }
  }

  const Soup& soup_;
  Context& context_;
  MeshWriteReport& report_;
  std::string out_;
  std::vector<std::int64_t> entry_;  // in the list of colours: of vertices, or of triangles with -1 for none
  std::uint64_t repeated_ = 0;
};

}  // namespace

void write_threemf(AtomicFile& file, const Soup& soup, Context& context, MeshWriteReport& report) {
  file.write(zip_of({{"[Content_Types].xml", content_types},
                     {"_rels/.rels", relationships},
                     {"3D/3dmodel.model", ModelWriter(soup, context, report).run()}},
                    file.path()));
}

}  // namespace tri::io_detail
