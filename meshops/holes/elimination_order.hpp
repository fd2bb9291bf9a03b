#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"

namespace tri {

struct SparseColumns;

/// How large a pattern is before it is divided.
struct EliminationLimits {
  std::int64_t at_once = 2'400'000;  ///< entries of a whole that is ordered as it is, which takes some 80 ms
  std::int64_t few = 10'000;         ///< entries of a part that is not divided further
};

/// In which order to eliminate the unknowns of a symmetric pattern, so that few entries come up. For up to `at_once`
/// entries, and each part that hangs together and has no more, it is the order of approximate minimum degree [Amestoy,
/// Davis & Duff 1996, by Eigen's AMDOrdering]. A larger part is halved by as few unknowns as possible, which come last,
/// again and again [nested dissection: George 1973; cut between the two ends of breadth-first searches: Gibbs, Poole &
/// Stockmeyer 1976]: on meshes it fills in a tenth more than the other for 100,000 unknowns, no more for a million, and
/// a cancel is heeded.
/// @return which unknown comes where
/// @throws Cancelled within some 80 ms
std::vector<std::int32_t> elimination_order(const SparseColumns& a, const Context& context,
                                            const EliminationLimits& limits = {});

}  // namespace tri
