#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libtri/registration.hpp"

namespace tri {

/// Indices of points equal to an earlier one, coordinate for coordinate; ascending.
/// @param context  null: cannot be cancelled @throws Cancelled
std::vector<std::uint32_t> find_duplicates(std::span<const Vec3> points, const Context* context = nullptr);

/// Robust standard deviation of the deviations, mm: 1.4826 times the median of their absolute values [Huber 1981].
double robust_sigma(std::span<const Foot> feet);

/// Indices of points that do not belong to the surface, ascending.
///
/// With a given `distance`, mm: every point farther from the model. Else those farther than 8 `robust_sigma` (at least
/// 1e-4 of the model's diagonal) that also stand apart from their neighbours by as much: a dent of the part, whose
/// points deviate together, is kept.
/// @param feet  one per point; those with face < 0 are not looked at
std::vector<std::uint32_t> find_outliers(std::span<const Foot> feet, double diagonal, std::optional<double> distance);

/// As above, for a `sigma` that is `robust_sigma(feet)`.
std::vector<std::uint32_t> find_outliers(std::span<const Foot> feet, double diagonal, std::optional<double> distance,
                                         double sigma);

}  // namespace tri
