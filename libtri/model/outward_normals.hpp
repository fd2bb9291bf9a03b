#pragma once

#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/model/trim_region.hpp"
#include "libtri/surfaces/curve_piece.hpp"

namespace tri {

/// Unit outward normal of a face at (u,v); beside a pole, where du x dv vanishes, its limit from within the face.
Vec3 outward_normal(const CadFace& face, const TrimRegion& region, const Vec2& uv);

/// Normals whose sign against p - foot says on which side of the model p lies when its foot is on an edge or a vertex:
/// the sum of the adjacent faces' normals along an edge, weighted by the faces' angles at a vertex
/// [Baerentzen & Aanaes 2005].
class PseudoNormals {
 public:
  PseudoNormals() = default;
  /// @param curves every trimming curve of the model; copies are kept
  PseudoNormals(const CadModel& model, const std::vector<TrimRegion>& regions, const std::vector<FaceCurve>& curves);

  /// At parameter t of face curve `index`; not of unit length.
  Vec3 at(const CadModel& model, const std::vector<TrimRegion>& regions, const std::vector<FaceCurve>& curves,
          std::uint32_t index, double t) const;
  /// Face curves of an edge.
  const std::vector<std::uint32_t>& uses(std::int32_t edge) const { return uses_[edge]; }

 private:
  std::vector<std::vector<std::uint32_t>> uses_;  // per edge
  std::vector<Vec3> vertices_;                    // per vertex
  std::vector<Vec3> poles_;                       // per face curve; zero where it is no pole
};

}  // namespace tri
