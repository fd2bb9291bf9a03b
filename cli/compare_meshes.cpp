#include <fmt/format.h>

#include <algorithm>

#include "cli/compare_options.hpp"
#include "io/html_text.hpp"
#include "meshops/mesh_distance.hpp"
#include "meshops/version.hpp"

namespace tri::cli {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Vec3& p) { return {p[0], p[1], p[2]}; }

Json to_json(const OneSidedDistance& d) {
  return {{"vertices", d.vertices.size()}, {"area", d.area}, {"samples", d.samples}, {"mean", d.mean}, {"mean_error", d.mean_error},
          {"rms", d.rms}, {"max", d.max}, {"max_bound", d.max_bound}, {"place", to_json(d.place)}, {"foot", to_json(d.foot)}};
}

std::string line(const std::string& from, const std::string& to, const OneSidedDistance& d) {
  std::string text = fmt::format("from {} to {}: mean {:.6g} ± {:.2g}, RMS {:.6g}, greatest {:.6g} (at most {:.6g}) at ({:.6g}, {:.6g}, {:.6g})\n",
                                 from, to, d.mean, d.mean_error, d.rms, d.max, d.max_bound, d.place[0], d.place[1], d.place[2]);
  return text + (d.samples > 0 ? fmt::format("  over {} places, {:.3g} a square unit\n", with_commas(d.samples), static_cast<double>(d.samples) / d.area)
                               : "  over the vertices, as the surface has no area\n");
}

}  // namespace

int compare_meshes(const CompareOptions& o, Program& program) {
  Context& context = program.context;
  const std::string &a = o.inputs[0], &b = o.inputs[1];
  CompareResults results;
  Soup& first = results.colored;
  first = read_measured(a, o, program);
  const Soup second = read_measured(b, o, program);
  MeshDistanceOptions options;
  if (o.samples > 0) options.samples = o.samples;
  options.seed = o.seed;
  const MeshDistance d = mesh_distance(first, second, options, context);

  results.json = {{"version", version}, {"options", cli::to_json(o)}, {"hausdorff", d.hausdorff}, {"hausdorff_bound", d.hausdorff_bound},
                  {"mean", d.mean}, {"rms", d.rms}, {"forward", to_json(d.forward)}, {"backward", to_json(d.backward)}};
  results.text = fmt::format("Hausdorff distance {:.6g}, proven to be at most {:.6g}\nRMS {:.6g}, mean {:.6g} over both surfaces\n", d.hausdorff,
                             d.hausdorff_bound, d.rms, d.mean) +
                 line(a, b, d.forward) + line(b, a, d.backward);
  results.csv = "from,to,area,samples,mean,mean_error,rms,max,max_bound\n";
  return finish(o, program, results);
}

}  // namespace tri::cli
