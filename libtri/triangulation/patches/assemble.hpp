#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/registration.hpp"
#include "libtri/triangulation/patches.hpp"
#include "libtri/triangulation/shell/edit_mesh.hpp"
#include "meshops/context.hpp"

namespace tri {

/// All faces triangulated and joined along their edges, before any auxiliary vertex is removed.
struct AssembledPatches {
  /// The points, in their order, then the auxiliary vertices. Positions are feet. Points without a foot are in no
  /// triangle.
  EditMesh mesh;
  EditMesh separate;  ///< the same with no face joined to another, if asked for
  /// Per auxiliary vertex: whether it lies on an edge between two faces or on a free edge, rather than inside a face or
  /// on its seam.
  std::vector<std::uint8_t> on_contour;
  std::vector<std::uint8_t> uniform_faces;               ///< per face: FaceDomain::uniform
  std::vector<std::array<std::uint32_t, 2>> duplicates;  ///< (duplicate, kept)
  std::vector<int> failed_faces;                         ///< positions in CadModel::faces
};

/// Steps (c) and (d) of [Ristic et al. 2000]. The mesh has the topology of the model but for failed faces, which are
/// left out.
/// @throws Cancelled
AssembledPatches assemble_patches(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points,
                                  const PatchesOptions& options, const Context& context);

}  // namespace tri
