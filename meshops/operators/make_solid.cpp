#include "meshops/operators/make_solid.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/arrangement/solid_from_soup.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr int passes = 4;

}  // namespace

const OptionSchema& MakeSolidOptions::schema() {
  using O = MakeSolidOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("max-deviation", &O::max_deviation,
                  {.unit = "of the diagonal", .min = 0, .max = 0.1, .help = "walls and sheets nearer than this to what stays go"})
          .boolean("keep-walls", &O::keep_walls, {.help = "other walls and sheets stay, as thin gaps and plates"});
  return schema;
}

Report make_solid(Soup& soup, const MakeSolidOptions& options, Context& context) {
  validate(options);
  check_soup(soup);
  context.checkpoint();
  Report report;
  report.operation = "make-solid";
  Soup work = soup;
  SolidFromSoup(work, options.max_deviation, options.keep_walls).run(report, true, context);
  // What the rounding of new vertices made cross is found by looking again; a solid is only looked at.
  for (int pass = 1; pass < passes && !report.unchanged(); ++pass) {
    Report again;
    SolidFromSoup(work, options.max_deviation, options.keep_walls).run(again, false, context);
    if (again.unchanged()) break;
    report.figures["passes"] = pass + 1;
    report.skipped = again.skipped;
    report.touched_faces = again.touched_faces;
    report.vertices_added += again.vertices_added;
    report.vertices_removed += again.vertices_removed;
    report.vertices_moved += again.vertices_moved;
    report.faces_added += again.faces_added;
    report.faces_removed += again.faces_removed;
  }
  if (!report.unchanged()) soup = std::move(work);
  context.progress("make-solid", 1);
  return report;
}

}  // namespace tri
