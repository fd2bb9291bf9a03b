#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/registration.hpp"
#include "libtri/triangulation/point_mesh.hpp"
#include "meshops/context.hpp"
#include "meshops/report.hpp"

namespace tri {

struct PatchesOptions {
  /// Share of the local point spacing within which a point counts as lying on an edge of the model, so that both faces
  /// use it.
  double edge_reach = 0.1;
  /// Largest distance between auxiliary vertices on an edge, in local point spacings.
  double edge_spacing = 1.0;
  /// Also make `PatchConnection::patches`.
  bool keep_patches = false;
};

struct PatchConnection {
  PointMesh mesh;
  /// Before stitching: one patch per face, of triangles whose corners all lie on that face. Made from the faces before
  /// they are joined, so it is not a part of `mesh`; faces with fewer than three points have none.
  PointMesh patches;
  std::vector<Report> reports;  ///< one per step, in order
  /// (duplicate, kept): points at the very position of another, which are in no triangle.
  std::vector<std::array<std::uint32_t, 2>> duplicates;
  /// Positions in CadModel::faces that could not be triangulated, because their trimming loops cross or touch. Their
  /// points are in no triangle.
  std::vector<int> failed_faces;
  std::size_t open_stars = 0;  ///< auxiliary vertices that could not be removed; their triangles are left out
};

/// Triangulates registered points face by face and joins the faces [Ristic et al. 2000, steps (c) to (g)].
///
/// (c) Each face's feet are triangulated in its (u,v), scaled to millimetres, by `delaunay`. The trimming loops take
/// part as chains of auxiliary vertices, forced in as segments [Sloan 1993], so that no triangle crosses them; what
/// lies beyond them goes, which is the third criterion of (e) made exact. Two faces share the chain of a common edge; a
/// closed face shares its seam with itself; a pole is one vertex. So the whole has the topology of the model before any
/// distance is looked at. (d) Triangles name points, so the connectivity is lifted to the measured positions. (f) Each
/// auxiliary vertex goes by the best triangulation of the polygon around it: first those on seams and poles, then
/// those on shared edges, which closes the gaps between the contours and the corners where
/// several faces meet; at free edges the mesh recedes to the outermost points. A triangulation that would change the
/// topology is never taken, so faces with few points or none come out joined. (g) Diagonals are flipped while that
/// lowers the sum of area, misfit to the model's normals and shape.
///
/// @param feet    one per point; points whose foot has face -1 are left out
/// @param points  mm
/// @throws InvalidInput if the sizes differ or an option is not positive; Cancelled.
PatchConnection connect_by_patches(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points,
                                   const PatchesOptions& options, Context& context);

}  // namespace tri
