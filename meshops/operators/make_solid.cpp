#include "meshops/operators/make_solid.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/arrangement/solid_from_soup.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {

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
  SolidFromSoup solid(soup, options.max_deviation, options.keep_walls);
  solid.run(report, context);
  return report;
}

}  // namespace tri
