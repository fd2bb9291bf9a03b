#pragma once

#include <cstdint>
#include <optional>
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

/// What the result is to be, and how far it may be from what was given.
struct RepairOptions {
  RepairGoal goal = RepairGoal::automatic;  ///< what the result is to be
  /// How far the surface may move, as a share of the diagonal of the bounding box; in [0, 0.1]. A bound for both
  /// directions: no place of the surface that was given ends farther than this from the result, and no place of the
  /// result lies farther from the surface that was given, but for new faces that close holes, where nothing was given.
  /// The steps keep within it by their own tolerances (`remove_degenerate`, `remove_self_intersections`, `make_solid`);
  /// where a place is found beyond it at the end (`places_beyond`), the step that took it there is undone as a whole.
  /// What is not done for it counts as `left`.
  double max_deviation = 5e-4;
  /// The result is for a file of floats without indices (STL): see `MakeSolidOptions::single_precision`.
  bool single_precision = false;
};

/// Where a step changed something: an element of the mesh as the step left it, and its (middle's) position.
struct RepairPlace {
  bool is_triangle = true;  ///< else a vertex
  std::uint32_t index = 0;  ///< of the triangle or vertex
  Vec3 at{0, 0, 0};         ///< where it is, in model units
};

/// How far the result is from the input, model units: the greatest distances found, of which some may be missed by as
/// much as `MeshDistance` says. `lost` is within `RepairOptions::max_deviation`; `added` is as well unless holes were
/// closed.
struct RepairDeviation {
  double lost = 0;         ///< from a place of the input to the result: what went, or moved
  Vec3 lost_at{0, 0, 0};   ///< on the input
  double added = 0;        ///< from a place of the result to the input: what moved, and what closes holes
  Vec3 added_at{0, 0, 0};  ///< on the result
};

/// What `repair` did.
struct RepairResult {
  static constexpr std::size_t most_places = 1000;  ///< of each step

  RepairGoal goal = RepairGoal::solid;           ///< as decided
  std::vector<Report> steps;                     ///< every step, also those that had nothing to do
  std::vector<std::vector<RepairPlace>> places;  ///< of each step, the first of them
  std::optional<RepairDeviation> deviation;      ///< if something changed
  bool changed = false;                          ///< else the soup is bit for bit what it was
  /// What could not be repaired; `skipped` of the steps says what: "beyond max-deviation, undone" of a step that would
  /// have moved the surface too far, with the places in its notes.
  std::uint64_t left = 0;
};

/// Runs the operators that make a clean mesh of any triangles, in this order: `weld`, `remove_duplicates`,
/// `resolve_t_junctions`, `stitch_boundaries`; then for a solid `make_solid`, for a surface `remove_degenerate`,
/// `remove_self_intersections`, `orient` and `split_non_manifold`. No component is removed. What is a solid already
/// (see `is_clean_solid`) is returned as it is, whatever coincident or unused vertices it has, unless the goal is a
/// surface.
///
/// The automatic goal is a solid if the loops of the boundary, each squared and divided by the area, come to less than
/// 4 together (a hemisphere has 6.3, a flat square 16), or there are none.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; Cancelled. The soup is then as it
/// was.
RepairResult repair(Soup& soup, const RepairOptions& options, Context& context);

}  // namespace tri
