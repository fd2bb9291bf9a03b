#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "meshops/checks/mesh_summary.hpp"
#include "meshops/checks/soup_components.hpp"
#include "meshops/context.hpp"
#include "meshops/joining/t_junctions.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// From what on something is called a defect.
struct MeshCheckOptions {
  double needle = 1e-3;                ///< height over longest side below which a triangle is called a needle
  double t_junction_tolerance = 1e-6;  ///< share of the diagonal within which a vertex is on a boundary edge
  bool self_intersections = true;      ///< false: they are not looked for, and count as none
};

/// What a mesh is, taken as a whole.
enum class SurfaceKind {
  none,          ///< no triangle with an area
  solid,         ///< watertight, and every shell faces out of its material
  watertight,    ///< closed, manifold and coherently oriented
  open_surface,  ///< has a boundary, or is not manifold
};

/// Everything that may be wrong with a mesh, and where.
struct MeshCheck {
  MeshSummary summary;  ///< counts and sizes
  MeshPlaces places;    ///< where the defects are that the summary counts

  /// Triangles whose corners lie exactly on one line, those that name a vertex twice included.
  std::vector<std::uint32_t> degenerate;
  std::vector<std::uint32_t> needles;  ///< further triangles, below `MeshCheckOptions::needle`
  /// Of `places.duplicate_triangles`, those that face against the first triangle with their corners.
  std::uint64_t opposite_duplicates = 0;
  /// Vertices at the place of a lower one, with that one. They are no defect by themselves: sheets that touch need
  /// them.
  std::vector<std::array<std::uint32_t, 2>> coincident_vertices;
  /// Places where boundary edges coincide, so that welding would join them.
  std::uint64_t open_seams = 0;
  /// Vertices on boundary sides of triangles that do not have them as a corner.
  std::vector<TJunction> t_junctions;
  /// Closed and coherently oriented shells that face inward and are no cavity of a solid, each by its first triangle.
  std::vector<std::uint32_t> inside_out;
  /// The same of those that face outward within solid material. They are no defect: solids in a solid, as of a second
  /// material, though someone may have meant cavities (`orient` makes such of them).
  std::vector<std::uint32_t> nested_solids;
  /// Pairs of triangles that meet in more than the corners and sides they share; vertices at the same place count as
  /// the same.
  std::vector<std::array<std::uint32_t, 2>> self_intersections;
  /// Parts joined over edges, as `soup_components` gives them.
  std::vector<SoupComponent> components;

  bool watertight = false;  ///< no boundary, manifold, coherently oriented; and there is a triangle
  /// What the whole is called in a verdict.
  SurfaceKind kind = SurfaceKind::none;

  /// The number of defects of each kind that has any, by name: "non-manifold edges" … Needles, coincident vertices and
  /// solids within solids are none. A boundary loop is one of a mesh that is meant to be closed, which nobody can tell
  /// from the mesh.
  /// @param boundary_is_wrong whether it is meant to be closed
  std::vector<std::pair<const char*, std::uint64_t>> defects(bool boundary_is_wrong) const;
};

/// Looks for everything that may be wrong with triangles of any topology; changes nothing.
///
/// Triangles that name a vertex twice have no edges. Non-manifold edges have three triangles or more, non-manifold
/// vertices more than one fan. A boundary loop that touches itself or another one in a vertex counts as if the fans
/// were apart there (other tools count what hangs together as one). A shell within others is right if it faces outward,
/// also as a solid in the cavity of another, or inward as a cavity. That triangles intersect does not keep a mesh from
/// being a solid. O(N log N), and what the self-intersections cost.
/// @throws InvalidInput if the soup is inconsistent; Cancelled.
MeshCheck check_mesh(const Soup& soup, const MeshCheckOptions& options, Context& context);

/// Everything as JSON: "verdict", "counts", "defects", "places" (lists of indices) and "components", at most `most` of
/// each; "…_more" says how many there are beyond that.
nlohmann::ordered_json to_json(const MeshCheck& check, std::size_t most);

/// "solid", "watertight", "open surface" or "no surface".
const char* to_string(SurfaceKind kind);

}  // namespace tri
