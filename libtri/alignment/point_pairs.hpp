#pragma once

#include <cstdint>
#include <vector>

#include "libtri/alignment/pose.hpp"
#include "libtri/alignment/scan_normals.hpp"
#include "libtri/alignment/surface_samples.hpp"

namespace tri {

/// A pose that takes one pair of measured points to a pair of samples with like distance and normals.
struct PairPose {
  Pose pose;
  int orientation = 0;  ///< the scan's normals point along (+1) or against (-1) the model's; 0: they tell no side
};

/// Poses from nothing: pairs of measured points with their normals are looked up among pairs of samples of the model
/// with the same four features (distance, three angles) [Drost, Ulrich, Navab & Ilic 2010].
///
/// Where the scan's normals tell no side, every combination of signs is looked up. Of the poses returned a few among
/// thousands are near a right one, to some hundredths of the part's size and some degrees: they are to be scored.
/// @param diagonal  mm, of the model
/// @param pairs     measured pairs to look up
/// @param each      poses made of a pair, at most
std::vector<PairPose> pair_poses(const ScanSubset& scan, const SurfaceSamples& samples, double diagonal,
                                 std::size_t pairs, std::size_t each, std::uint64_t seed, const Context& context);

}  // namespace tri
