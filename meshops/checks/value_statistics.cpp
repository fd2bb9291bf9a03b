#include "meshops/checks/value_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "meshops/error.hpp"
#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t values_block = 1 << 14;

// Count, mean and sum of squared differences from the mean; the mean square is kept by itself, since adding the square
// of a large mean afterwards would lose nothing but taking it away would.
struct Moments {
  double count = 0, mean = 0, squares = 0, mean_square = 0;
  double min = 0, max = 0;
  std::size_t min_index = 0, max_index = 0;
  std::uint64_t inside = 0;

  void add(double value, std::size_t index) {
    if (count == 0 || value < min) min = value, min_index = index;
    if (count == 0 || value > max) max = value, max_index = index;
    count += 1;
    const double difference = value - mean;
    mean += difference / count;
    squares += difference * (value - mean);
    mean_square += (value * value - mean_square) / count;
  }

  void merge(const Moments& other) {
    if (other.count == 0) return;
    if (count == 0) {
      *this = other;
      return;
    }
    if (other.min < min) min = other.min, min_index = other.min_index;
    if (other.max > max) max = other.max, max_index = other.max_index;
    const double total = count + other.count, share = other.count / total, difference = other.mean - mean;
    squares += other.squares + difference * difference * count * share;
    mean += difference * share;
    mean_square += (other.mean_square - mean_square) * share;
    count = total;
    inside += other.inside;
  }
};

}  // namespace

double percentile(std::span<double> values, double share) {
  if (values.empty()) return 0;
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(below);
  std::nth_element(values.begin(), at, values.end());
  const double fraction = place - static_cast<double>(below);
  if (fraction == 0) return *at;
  const double next = *std::min_element(at + 1, values.end());
  return *at + fraction * (next - *at);
}

ValueStatistics value_statistics(std::span<const double> values, const std::optional<Tolerance>& tolerance,
                                 const Context& context) {
  ValueStatistics result;
  if (values.empty()) return result;
  std::vector<Moments> partial((values.size() + values_block - 1) / values_block);
  for_each_block(context, "", values.size(), values_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    Moments m;
    for (std::size_t i = begin; i < end; ++i) {
      m.add(values[i], i);
      if (tolerance && tolerance->holds(values[i])) ++m.inside;
    }
    partial[block] = m;
  });
  Moments all;
  for (const Moments& m : partial) all.merge(m);
  result.count = values.size();
  result.mean = all.mean;
  result.rms = std::sqrt(all.mean_square);
  if (values.size() > 1) result.standard_deviation = std::sqrt(all.squares / (all.count - 1));
  result.min = all.min;
  result.max = all.max;
  result.min_index = all.min_index;
  result.max_index = all.max_index;
  result.in_tolerance = all.inside;
  std::vector<double> copy(values.begin(), values.end());
  result.median = percentile(copy, 0.5);
  result.p5 = percentile(copy, 0.05);
  result.p95 = percentile(copy, 0.95);
  return result;
}

Histogram histogram(std::span<const double> values, double low, double high, int bins) {
  if (!(low < high) || !std::isfinite(high - low))
    throw InvalidInput("a histogram from " + std::to_string(low) + " to " + std::to_string(high) + " has no width");
  if (bins < 1) throw InvalidInput("a histogram of " + std::to_string(bins) + " bins; at least 1 is needed");
  Histogram result{low, high, std::vector<std::uint64_t>(static_cast<std::size_t>(bins), 0)};
  for (const double value : values) {
    if (value < low) {
      ++result.below;
    } else if (value > high) {
      ++result.above;
    } else {
      const auto bin = static_cast<std::size_t>((value - low) / (high - low) * bins);
      ++result.bins[std::min(bin, result.bins.size() - 1)];
    }
  }
  return result;
}

double range_to_show(std::span<const double> values) {
  std::vector<double> sizes;
  sizes.reserve(values.size());
  for (const double v : values) sizes.push_back(std::abs(v));
  const double most = percentile(sizes, 0.98);
  if (!(most > 0)) return 0;
  // The decimal that is meant, not a product that misses it by a rounding.
  const int exponent = static_cast<int>(std::floor(std::log10(most))) - 1;
  const double power = std::pow(10.0, std::abs(exponent));
  const double digits = std::ceil(exponent < 0 ? most * power : most / power);
  return exponent < 0 ? digits / power : digits * power;
}

std::vector<std::uint32_t> worst_places(std::span<const Vec3> points, std::span<const double> severity, double radius,
                                        std::size_t count) {
  std::vector<std::uint32_t> chosen;
  std::vector<double> left(severity.begin(), severity.end());
  for (double& s : left)
    if (std::isnan(s)) s = -std::numeric_limits<double>::infinity();
  while (chosen.size() < count && !left.empty()) {
    const auto worst = std::max_element(left.begin(), left.end());
    if (!(*worst > -std::numeric_limits<double>::infinity())) break;
    const auto index = static_cast<std::uint32_t>(worst - left.begin());
    chosen.push_back(index);
    for (std::size_t i = 0; i < left.size(); ++i)
      if ((points[i] - points[index]).norm() <= radius) left[i] = -std::numeric_limits<double>::infinity();
  }
  return chosen;
}

}  // namespace tri
