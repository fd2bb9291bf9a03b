#include "libtri/alignment/fit_quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "meshops/for_each_block.hpp"
#include "meshops/limits.hpp"
#include "meshops/search/nearest_points.hpp"

namespace tri {
namespace {

constexpr double inlier_sigmas = 4.685;
constexpr double near_limit = 5e-3;        // of the size
constexpr double far_limit = 5e-4;         // of the size
constexpr double clip = 1e-2;              // of the size: a point farther off counts as so far
constexpr double far_neighbour = 2.5;      // times the usual distance: wild points in the air have no neighbours
constexpr std::size_t neighbours_far = 3;  // of four

}  // namespace

Neighbourhood neighbourhood(std::span<const Vec3> points, const Context& context) {
  Neighbourhood result(points.size());
  const NearestPoints tree(points);
  std::vector<std::array<double, 4>> squared(points.size());
  for_each_block(context, "", points.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
    std::vector<NearestPoints::Neighbor> near;
    for (std::size_t i = begin; i < end; ++i) {
      result[i].fill(static_cast<std::uint32_t>(i));
      tree.nearest(points[i], 5, near);
      std::size_t count = 0;
      for (const auto& n : near)
        if (n.index != i && count < 4) {
          squared[i][count] = n.squared_distance;
          result[i][count++] = n.index;
        }
    }
  });
  if (points.size() < 6) return result;
  std::vector<double> farthest;
  for (const auto& four : squared) farthest.push_back(four[3]);
  std::nth_element(farthest.begin(), farthest.begin() + static_cast<std::ptrdiff_t>(farthest.size() / 2),
                   farthest.end());
  const double limit = far_neighbour * far_neighbour * farthest[farthest.size() / 2];
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k)
      if (squared[i][k] > limit) result[i][k] = static_cast<std::uint32_t>(i);
  return result;
}

FitQuality fit_quality(std::span<const PointResidual> residuals, const Neighbourhood& neighbours, double size) {
  FitQuality q;
  q.sigma = robust_sigma(residuals, size);
  q.median = q.sigma / 1.4826;
  const double limit = inlier_sigmas * q.sigma, far = std::max(limit, far_limit * size);
  const auto value = [&](std::size_t i) {
    const PointResidual& r = residuals[i];
    return r.face < 0 || r.opposed ? clip * size : std::clamp(r.value, -clip * size, clip * size);
  };
  std::size_t inliers = 0, near = 0, coherent = 0;
  double squares = 0, products = 0, inlier_products = 0, paired_squares = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const double x = value(i);
    near += std::abs(x) <= near_limit * size;
    if (std::abs(x) <= limit) {
      ++inliers;
      squares += x * x;
    }
    std::size_t with_it = 0;
    double sum = 0, most = -infinity, least = infinity;
    int count = 0;
    for (const std::uint32_t n : neighbours[i]) {
      if (n == i) continue;
      const double y = value(n);
      sum += y;
      most = std::max(most, y);
      least = std::min(least, y);
      ++count;
      with_it += std::abs(y) > far && (x > 0) == (y > 0);
    }
    coherent += std::abs(x) > far && with_it >= neighbours_far;
    // The middle of the neighbours, so that a single wild one among them adds nothing.
    if (count < 3) continue;
    const double middle = (sum - most - least) / (count - 2);
    products += x * middle;
    if (std::abs(x) <= limit && std::abs(middle) <= limit) {
      inlier_products += x * middle;
      paired_squares += 0.5 * (x * x + middle * middle);
    }
  }
  const auto n = static_cast<double>(residuals.size());
  if (n == 0) return q;
  q.inlier_share = static_cast<double>(inliers) / n;
  q.near_share = static_cast<double>(near) / n;
  q.coherent_share = static_cast<double>(coherent) / n;
  q.rms = inliers > 0 ? std::sqrt(squares / static_cast<double>(inliers)) : 0;
  q.correlation = paired_squares > 0 ? std::clamp(inlier_products / paired_squares, 0.0, 1 - 1e-6) : 0;
  q.systematic = std::sqrt(std::max(0.0, products / n));
  return q;
}

}  // namespace tri
