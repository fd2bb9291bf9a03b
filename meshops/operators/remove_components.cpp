#include "meshops/operators/remove_components.hpp"

#include <algorithm>
#include <functional>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/checks/soup_components.hpp"
#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {

const OptionSchema& RemoveComponentsOptions::schema() {
  using O = RemoveComponentsOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("min-area", &O::min_area, {.unit = "mm2", .min = 0, .help = "components of less area go"})
          .number("min-volume", &O::min_volume,
                  {.unit = "mm3", .min = 0, .help = "components that enclose less go; open ones enclose nothing"})
          .integer("min-triangles", &O::min_triangles,
                   {.unit = "triangles", .min = 0, .help = "components of fewer go"})
          .integer("keep", &O::keep,
                   {.unit = "components", .min = 0, .help = "how many stay, those of the largest area; 0: all"});
  return schema;
}

Report remove_components(Soup& soup, const RemoveComponentsOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("remove-components", 0);
  check_soup(soup, &context);
  Report report;
  report.operation = "remove-components";
  if (options.min_area == 0 && options.min_volume == 0 && options.min_triangles == 0 && options.keep == 0) {
    context.progress("remove-components", 1);
    return report;
  }

  const Shells shells = find_shells(soup, context);
  context.progress("remove-components", 0.3);
  MeshPlaces places;
  const MeshSummary summary = summarize(soup, &places, &context);
  context.checkpoint();
  std::vector<SoupComponent> found = measure_components(soup, places.component_of_triangle, shells, &context);
  // Triangles that name a vertex twice are one more.
  std::vector<std::uint32_t>& component_of = places.component_of_triangle;
  if (summary.repeated_corners > 0) found.push_back({.triangles = summary.repeated_corners});
  for (const std::uint32_t t : places.repeated_corners) component_of[t] = static_cast<std::uint32_t>(found.size() - 1);
  std::vector<std::uint32_t> stay;
  for (std::uint32_t i = 0; i < found.size(); ++i)
    if (found[i].area >= options.min_area && found[i].absolute_volume >= options.min_volume &&
        found[i].triangles >= static_cast<std::uint64_t>(options.min_triangles))
      stay.push_back(i);
  if (options.keep > 0 && stay.size() > static_cast<std::size_t>(options.keep)) {
    std::ranges::stable_sort(stay, std::ranges::greater(), [&](std::uint32_t i) { return found[i].area; });
    stay.resize(static_cast<std::size_t>(options.keep));
  }
  context.checkpoint();
  report.figures["components kept"] = static_cast<double>(stay.size());
  if (stay.size() == found.size()) {
    context.progress("remove-components", 1);
    return report;
  }
  std::vector<char> stays(found.size(), 0);
  for (const std::uint32_t i : stay) stays[i] = 1;
  double area = 0;
  for (std::size_t i = 0; i < stays.size(); ++i)
    if (!stays[i]) area += found[i].area;
  report.figures["components removed"] = static_cast<double>(stays.size() - stay.size());
  report.figures["area removed"] = area;

  std::vector<char> keep(soup.triangles.size()), used(soup.points.size(), 0), had(soup.points.size(), 0);
  Pace pace(context);
  for (std::size_t i = 0; i < keep.size(); ++i) {
    pace();
    keep[i] = stays[component_of[i]];
    report.faces_removed += !keep[i];
    for (const std::uint32_t v : soup.triangles[i]) (keep[i] ? used : had)[v] = 1;
  }
  Soup work = soup;
  keep_triangles(work, keep, &context);
  std::vector<std::uint32_t> number(soup.points.size());
  std::uint32_t next = 0;
  for (std::size_t v = 0; v < number.size(); ++v, pace()) number[v] = used[v] || !had[v] ? next++ : dropped_point;
  report.vertices_removed = number.size() - next;
  if (report.vertices_removed > 0) renumber_points(work, number, next, &context);
  soup = std::move(work);
  context.progress("remove-components", 1);
  return report;
}

}  // namespace tri
