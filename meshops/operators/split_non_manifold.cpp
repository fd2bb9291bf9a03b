#include "meshops/operators/split_non_manifold.hpp"

#include <algorithm>
#include <iterator>

#include "meshops/joining/side_pairs.hpp"
#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {

const OptionSchema& SplitNonManifoldOptions::schema() {
  static const OptionSchema schema = Schema<SplitNonManifoldOptions>();
  return schema;
}

Report split_non_manifold(Soup& soup, const SplitNonManifoldOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("split-non-manifold", 0);
  check_soup(soup, &context);
  Pace pace(context);
  Report report;
  report.operation = "split-non-manifold";
  std::vector<Triangle> whole;
  std::vector<std::uint32_t> source;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i, pace()) {
    if (repeats_vertex(soup.triangles[i])) continue;
    whole.push_back(soup.triangles[i]);
    source.push_back(i);
  }
  SidePairs pairs = pair_sides(whole, soup.points.size(), context);
  context.progress("split-non-manifold", 0.4);
  if (pairs.same_way.empty() && pairs.crowded.empty() &&
      vertices_with_several_fans(whole, soup.points.size(), pairs.twin, context).empty()) {
    context.progress("split-non-manifold", 1);
    return report;
  }
  const ManifoldRepairs repairs = make_manifold(whole, soup.points, pairs, context);
  context.checkpoint();

  const auto touched = [&](const std::vector<std::uint32_t>& triangles) {
    for (const std::uint32_t t : triangles) report.touched_faces.push_back(source[t]);
  };
  touched(repairs.reversed_triangles);
  touched(repairs.detached_triangles);
  std::ranges::sort(report.touched_faces);
  report.touched_faces.erase(std::unique(report.touched_faces.begin(), report.touched_faces.end()),
                             report.touched_faces.end());
  report.faces_reversed = repairs.reversed_triangles.size();
  report.vertices_added = repairs.copied_points.size();
  const auto figure = [&](const char* name, std::size_t count) {
    if (count > 0) report.figures[name] = static_cast<double>(count);
  };
  figure("edges of three or more triangles split", repairs.crowded.size());
  figure("edges cut", repairs.cut.size());
  figure("triangles detached", repairs.detached_triangles.size());

  Soup work = soup;
  for (const std::uint32_t t : repairs.reversed_triangles) reverse_triangle(work, source[t]);
  for (const std::uint32_t p : repairs.copied_points) {
    pace();
    report.touched_vertices.push_back(copy_point(work, p));
  }
  for (std::size_t i = 0; i < whole.size(); ++i, pace()) work.triangles[source[i]] = whole[i];
  soup = std::move(work);
  context.progress("split-non-manifold", 1);
  return report;
}

}  // namespace tri
