#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libtri/cad_model.hpp"
#include "libtri/registration.hpp"
#include "meshops/context.hpp"
#include "meshops/mesh.hpp"
#include "meshops/report.hpp"

namespace tri {

struct PatchesOptions {
  /// Share of the local point spacing within which a point counts as lying on an edge of the model, so that both faces use it.
  double edge_reach = 0.1;
  /// Largest distance between auxiliary vertices on an edge, in local point spacings.
  double edge_spacing = 1.0;
  /// Also make `PatchesResult::patches`.
  bool keep_patches = false;
};

struct PatchesResult {
  /// Every point with a foot is a vertex, at its measured position, but for `duplicates`. Vertices are in the order of the points and
  /// carry the properties of `tri::property`.
  Mesh mesh;
  /// The mesh before stitching: one patch per face, of triangles whose corners lie on that face; the same properties.
  Mesh patches;
  std::vector<Report> reports;  ///< one per step, in order
  /// (duplicate, kept): points at the very position of another, which are in no triangle.
  std::vector<std::array<std::uint32_t, 2>> duplicates;
  /// Points with a foot that are in no triangle, because their face could not be triangulated or is too small to hold one.
  std::vector<std::uint32_t> unused_points;
  /// Positions in CadModel::faces that could not be triangulated: trimming loops that cross or touch.
  std::vector<int> failed_faces;
};

/// Triangulates registered points face by face and joins the faces [Ristic et al. 2000, steps (c) to (g)].
///
/// (c) Each face's feet are triangulated in its (u,v), scaled to millimetres, by `delaunay`. The trimming loops take part as chains of
/// auxiliary vertices, forced in as segments [Sloan 1993], so that no triangle crosses them; what lies beyond them goes,
/// which is the third criterion of (e) made exact. Two faces share the chain of a common edge; a closed face shares its seam with itself;
/// a pole is one vertex. So the whole has the topology of the model before any distance is looked at.
/// (d) Vertices are lifted to the measured points.
/// (f) Each auxiliary vertex goes by the best triangulation of the polygon around it: first those on seams and poles, which leaves the patches,
/// then those on shared edges, which closes the gaps between the contours and the corners where several faces meet; at free edges the mesh recedes
/// to the outermost points. A triangulation that would change the topology is never taken, so faces with few points or none
/// come out joined.
/// (g) Diagonals are flipped until every edge is Delaunay on the surface.
///
/// @param feet    one per point; points whose foot has face -1 are left out
/// @param points  mm
/// @throws InvalidInput if the sizes differ or an option is not positive; Cancelled between steps.
PatchesResult triangulate_patches(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points,
                                  const PatchesOptions& options, Context& context);

}  // namespace tri
