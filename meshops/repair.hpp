#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What a repair is to end with.
enum class RepairGoal {
  automatic,  ///< a solid where the boundary is short (see `repair`), else a surface
  solid,      ///< closed, manifold, facing outward, without self-intersections
  surface     ///< manifold and coherently oriented; open where it was open
};

struct RepairOptions {
  RepairGoal goal = RepairGoal::automatic;
  /// How far the surface may move, as a share of the diagonal of the bounding box; in [0, 0.1].
  double max_deviation = 5e-4;
};

/// What `repair` did.
struct RepairResult {
  RepairGoal goal = RepairGoal::solid;  ///< as decided
  std::vector<Report> steps;            ///< every step, also those that had nothing to do
  bool changed = false;                 ///< else the soup is bit for bit what it was
  std::uint64_t left = 0;               ///< what could not be repaired; `skipped` of the steps says what
};

/// Runs the operators that make a clean mesh of any triangles, in this order: `weld`, `remove_duplicates`,
/// `resolve_t_junctions`, `stitch_boundaries`; then for a solid `make_solid`, for a surface `remove_degenerate`, `orient` and
/// `split_non_manifold`. No component is removed.
///
/// The automatic goal is a solid if the loops of the boundary, each squared and divided by the area, come to less than 4
/// together (a hemisphere has 6.3, a flat square 16), or there are none.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it was.
RepairResult repair(Soup& soup, const RepairOptions& options, Context& context);

}  // namespace tri
