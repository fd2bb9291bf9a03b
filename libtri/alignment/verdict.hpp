#pragma once

#include "libtri/alignment/align.hpp"

namespace tri {

/// True if nearly all that a fit shows is noise and single wild points: what a right pose of the right part gives.
/// @param size  mm, as `fit_size`
bool fits(const FitQuality& quality, double size);

/// Sets `status` and adds to `reasons`, from everything else in `result`.
/// @param points  that were given; @param size mm, as `fit_size`
void judge(AlignResult& result, std::size_t points, double size);

}  // namespace tri
