#include "meshops/operators/make_solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "meshops/arrangement/solid_from_soup.hpp"
#include "meshops/solid_check.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr int passes = 4;

constexpr std::size_t named = 10;

Vec3 middle_of(const Soup& soup, std::uint32_t t) {
  const Triangle& v = soup.triangles[t];
  return (soup.points[v[0]] + soup.points[v[1]] + soup.points[v[2]]) / 3.0;
}

/// A note for each of the first few.
void name_places(Report& report, const char* what, const char* how, const std::vector<std::uint32_t>& list, const auto& place) {
  for (std::size_t i = 0; i < std::min(named, list.size()); ++i) {
    const Vec3 p = place(list[i]);
    report.notes.push_back(fmt::format("{} {} {} ({:.6g}, {:.6g}, {:.6g})", what, list[i], how, p[0], p[1], p[2]));
  }
}

/// To the nearest numbers of single precision.
void round_points(Soup& soup, Report& report) {
  for (Vec3& p : soup.points) {
    const Vec3 rounded(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    report.vertices_moved += rounded != p;
    p = rounded;
  }
}

void tell_what_is_left(const Soup& soup, const SurfaceContacts& left, bool touching_counts, Report& report) {
  if (!left.crossing.empty()) report.skipped["pairs that still cross"] = left.crossing.size();
  if (!left.flat.empty()) report.skipped["triangles without area"] = left.flat.size();
  std::vector<std::uint32_t> crossing;
  for (const auto& pair : left.crossing) crossing.push_back(pair[0]);
  const auto middle = [&](std::uint32_t t) { return middle_of(soup, t); };
  name_places(report, "triangle", "still crosses another near", crossing, middle);
  name_places(report, "triangle", "has no area, at", left.flat, middle);
  const std::vector<std::uint32_t> touching = touching_vertices(soup);
  if (touching.empty()) return;
  if (!touching_counts) {  // a file with indices keeps them apart
    report.figures["vertices that touch others"] = static_cast<double>(touching.size());
    return;
  }
  report.skipped["vertices that still touch others"] = touching.size();
  name_places(report, "vertex", "still touches another at", touching, [&](std::uint32_t v) { return soup.points[v]; });
}

}  // namespace

const OptionSchema& MakeSolidOptions::schema() {
  using O = MakeSolidOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("max-deviation", &O::max_deviation,
                  {.unit = "of the diagonal", .min = 0, .max = 0.1, .help = "walls and sheets nearer than this to what stays go"})
          .boolean("keep-walls", &O::keep_walls, {.help = "other walls and sheets stay, as thin gaps and plates"})
          .boolean("single-precision", &O::single_precision,
                   {.help = "the result stays a solid in a file that holds floats and no indices (STL)"});
  return schema;
}

Report make_solid(Soup& soup, const MakeSolidOptions& options, Context& context) {
  validate(options);
  check_soup(soup);
  context.checkpoint();
  Report report;
  report.operation = "make-solid";
  Soup work = soup;
  if (options.single_precision) round_points(work, report);
  if (is_clean_solid(work, options.single_precision, context)) {
    if (!report.unchanged()) soup = std::move(work);
    context.progress("make-solid", 1);
    return report;
  }
  const int finest = options.single_precision ? GridFrame::floats : GridFrame::doubles;
  SurfaceContacts left = SolidFromSoup(work, options.max_deviation, options.keep_walls, finest).run(report, true, context);
  // What the rounding of new vertices made cross is cut again.
  for (int pass = 1; pass < passes && !left.none(); ++pass) {
    Report again;
    left = SolidFromSoup(work, options.max_deviation, options.keep_walls, finest).run(again, false, context);
    report.figures["passes"] = pass + 1;
    report.touched_faces = again.touched_faces;
    report.vertices_added += again.vertices_added;
    report.vertices_removed += again.vertices_removed;
    report.vertices_moved += again.vertices_moved;
    report.faces_added += again.faces_added;
    report.faces_removed += again.faces_removed;
  }
  if (!left.none()) left = surface_contacts(work.points, work.triangles, context);
  tell_what_is_left(work, left, options.single_precision, report);
  if (!report.unchanged()) soup = std::move(work);
  context.progress("make-solid", 1);
  return report;
}

}  // namespace tri
