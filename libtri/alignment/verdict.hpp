#pragma once

#include "libtri/alignment/align.hpp"

namespace tri {

/// True if nearly all that a fit shows is noise and single wild points: what a right pose of the right part gives.
/// @param diagonal  mm, of the model
bool fits(const FitQuality& quality, double diagonal);

/// Sets `status` and adds to `reasons`, from everything else in `result`.
/// @param points  that were given; @param diagonal mm, of the model
void judge(AlignResult& result, std::size_t points, double diagonal);

}  // namespace tri
