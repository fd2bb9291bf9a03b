#pragma once

#include <limits>

#include "meshops/context.hpp"
#include "meshops/options.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Which triangles count as degenerate, and how far the surface may move.
struct RemoveDegenerateOptions {
  /// Triangles whose height over their longest side is at most this share of it are degenerate; those whose corners lie
  /// exactly on one line always are.
  double flatness = 1e-6;
  /// Model units; edges no longer than this are degenerate as well and are collapsed.
  double shortest_edge = 0;
  /// Model units; no place of the surface ends farther than this from where the surface was, nor the other way round:
  /// what moves displace one after another is added up, and a move that would go beyond is not done.
  double max_deviation = std::numeric_limits<double>::infinity();

  /// The fields as options with units, ranges and help; read-only, from any thread.
  static const OptionSchema& schema();
};

/// Removes triangles without an area worth the name, without leaving holes.
///
/// A cap (its third vertex within a long side) is taken out by splitting that side at the vertex: the triangles beyond
/// it are halved, which for an edge of two triangles is a flip, and the surface moves by no more than the cap's height.
/// A needle (one short side) is collapsed into one of the two ends. Of all that is possible the move that displaces
/// least is done. A move is refused if it would leave as many degenerate triangles as before (and no smaller ones),
/// turn a normal by 90 degrees or more (60 degrees if the collapse displaces more than the triangle is high), join
/// vertices that share other neighbours than the triangles at their edge, make an edge of more triangles, make two
/// triangles with the same corners, or pull in the boundary. So topology stays, on any soup, and every move lowers
/// (number of degenerate triangles, sum of their squared lengths), which ends the process. Triangles that name a vertex
/// twice and degenerate twins with the same corners have nothing around them to move and just go.
///
/// Of what is touched new triangles take the attributes of the one they are cut from, corners interpolated; an end that
/// stays keeps its place and attributes. Vertices that lose their last triangle go; new triangles come last. Time grows
/// with triangles, plus moves. Counts: `vertices_removed`, `faces_added`, `faces_removed`. Figures: "degenerate
/// triangles found", "caps removed", "needles collapsed". `skipped`: "no move that does no harm". `touched_faces` are
/// the changed and new ones.
/// @throws InvalidInput if an option is out of range or the soup is inconsistent; the soup is as it was. On cancel as
/// well.
Report remove_degenerate(Soup& soup, const RemoveDegenerateOptions& options, Context& context);

}  // namespace tri
