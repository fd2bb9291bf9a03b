#include "meshops/operators/make_solid.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/arrangement/solid_from_soup.hpp"
#include "meshops/solid_check.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr int passes = 4;

/// To the nearest numbers of single precision.
void round_points(Soup& soup, Report& report) {
  for (Vec3& p : soup.points) {
    const Vec3 rounded(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    report.vertices_moved += rounded != p;
    p = rounded;
  }
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
  if (!left.crossing.empty()) report.skipped["pairs that still cross"] = left.crossing.size();
  if (!left.flat.empty()) report.skipped["triangles without area"] = left.flat.size();
  if (!report.unchanged()) soup = std::move(work);
  context.progress("make-solid", 1);
  return report;
}

}  // namespace tri
