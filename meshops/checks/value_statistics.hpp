#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A band of values that are as they should be, both ends included; low <= high.
struct Tolerance {
  double low = 0;   ///< least value that is in the band
  double high = 0;  ///< greatest

  /// True if `value` is in the band; false for NaN.
  bool holds(double value) const { return value >= low && value <= high; }
  /// By how much `value` is outside; negative inside.
  double excess(double value) const { return value > 0.5 * low + 0.5 * high ? value - high : low - value; }
};

/// What a list of numbers is like. All in the numbers' own unit; all but `count` are 0 if there is none.
struct ValueStatistics {
  std::uint64_t count = 0;         ///< of the numbers
  double mean = 0;                 ///< arithmetic
  double rms = 0;                  ///< root of the mean square
  double standard_deviation = 0;   ///< about the mean, over count - 1; 0 for a single value
  double min = 0;                  ///< least value
  double max = 0;                  ///< greatest value
  std::size_t min_index = 0;       ///< where the first value is that is least
  std::size_t max_index = 0;       ///< where the first value is that is greatest
  double p5 = 0;                   ///< 5th percentile, interpolated linearly between the sorted values
  double median = 0;               ///< 50th percentile, likewise
  double p95 = 0;                  ///< 95th percentile, likewise
  std::uint64_t in_tolerance = 0;  ///< 0 without a tolerance
};

/// Sums run over blocks of fixed size that are merged in order by the update formulas of Chan, Golub & LeVeque (1983),
/// which do not cancel however far the mean is from 0; the result is the same for any number of threads.
/// @param values  finite
/// @throws Cancelled
ValueStatistics value_statistics(std::span<const double> values, const std::optional<Tolerance>& tolerance,
                                 const Context& context);

/// The value that `share` (0 to 1) of `values` do not exceed, interpolated linearly; 0 if there is none. Reorders
/// `values`.
double percentile(std::span<double> values, double share);

/// Half the width of a range about 0 to show `values` in: what 98% of them do not exceed in size, rounded up to two
/// digits so that it reads well. 0 if there is none or all are 0.
double range_to_show(std::span<const double> values);

/// How many values fall into each of equally wide bins from `low` to `high`.
struct Histogram {
  double low = 0;                   ///< where the first bin begins
  double high = 0;                  ///< where the last one ends
  std::vector<std::uint64_t> bins;  ///< a value on a border counts above it, `high` itself in the last bin
  std::uint64_t below = 0;          ///< values less than `low`
  std::uint64_t above = 0;          ///< values greater than `high`
};

/// @param bins  at least 1
/// @throws InvalidInput unless low < high and bins >= 1
Histogram histogram(std::span<const double> values, double low, double high, int bins);

/// The places where a surface is worst: the place of greatest `severity` first, then the greatest of those farther than
/// `radius` from all before, and so on.
/// @param severity  one per point; NaN and minus infinity are never chosen
/// @param radius    >= 0, model units
/// @return at most `count` indices into `points`
std::vector<std::uint32_t> worst_places(std::span<const Vec3> points, std::span<const double> severity, double radius,
                                        std::size_t count);

}  // namespace tri
