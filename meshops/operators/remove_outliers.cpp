#include "meshops/operators/remove_outliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "meshops/for_each_block.hpp"
#include "meshops/points/keep_points.hpp"
#include "meshops/search/nearest_points.hpp"

namespace tri {
namespace {

constexpr std::size_t outlier_block = 16384;

/// Mean distance of a point to its `count` nearest other points.
double mean_distance(const NearestPoints& tree, const std::vector<Vec3>& points, std::size_t i, std::size_t count) {
  thread_local std::vector<NearestPoints::Neighbor> near;
  tree.nearest(points[i], count + 1, near);
  // The point itself is one of those at distance 0, whichever the tree names first among coincident ones.
  double sum = 0;
  for (std::size_t k = 1; k < near.size(); ++k) sum += std::sqrt(near[k].squared_distance);
  return sum / static_cast<double>(count);
}

}  // namespace

const OptionSchema& RemoveOutliersOptions::schema() {
  using O = RemoveOutliersOptions;
  static const OptionSchema schema =
      Schema<O>()
          .integer("neighbors", &O::neighbors,
                   {.unit = "points", .min = 1, .max = 1000, .help = "nearest points whose mean distance is looked at"})
          .number("sigma", &O::sigma,
                  {.min = 0,
                   .infinite = true,
                   .help = "points go that are so many standard deviations above the mean distance"});
  return schema;
}

Report remove_outliers(PointSet& set, const RemoveOutliersOptions& options, Context& context) {
  validate(options);
  validate(set);
  context.checkpoint();
  context.progress("remove outliers", 0);
  Report report;
  report.operation = "remove-outliers";
  const std::size_t n = set.size();
  if (n < 2) {
    context.progress("remove outliers", 1);
    return report;
  }
  const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(options.neighbors), n - 1);
  const NearestPoints tree(set.points, &context);
  context.progress("remove outliers", 0.2);
  std::vector<double> distance(n);
  for_each_block(context, "measure distances", n, outlier_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) distance[i] = mean_distance(tree, set.points, i, count);
  });
  // In order of the points, so that rounding is the same on any number of threads.
  double sum = 0, squares = 0;
  for (const double d : distance) sum += d;
  const double mean = sum / static_cast<double>(n);
  for (const double d : distance) squares += (d - mean) * (d - mean);
  const double deviation = std::sqrt(squares / static_cast<double>(n - 1));
  const double limit =
      std::isinf(options.sigma) ? std::numeric_limits<double>::infinity() : mean + options.sigma * deviation;
  std::vector<std::uint32_t> kept;
  kept.reserve(n);
  for (std::size_t i = 0; i < n; ++i)
    if (distance[i] <= limit) kept.push_back(static_cast<std::uint32_t>(i));
  report.figures["mean distance"] = mean;
  report.figures["standard deviation"] = deviation;
  report.figures["limit"] = limit;
  context.checkpoint();
  keep_and_report(set, kept, report);
  context.progress("remove outliers", 1);
  return report;
}

}  // namespace tri
