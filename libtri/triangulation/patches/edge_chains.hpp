#pragma once

#include <cstdint>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "meshops/context.hpp"

namespace tri {

/// One use of an edge in the plane of its face: (u,v) scaled to millimetres, over the share of the edge's length in
/// space. Uses of one edge by two faces so have a parameter in common without relying on the file's.
class CoedgeCurve {
 public:
  /// @param scale  mm per unit of u and v
  CoedgeCurve(const CadFace& face, const Coedge& coedge, const Vec2& scale);

  int edge() const { return edge_; }
  bool reversed() const { return reversed_; }
  double length() const { return length_; }  ///< mm, in space; in the plane for an edge without length
  /// @param s  in [0,1], in the edge's own direction
  Vec2 plane_point(double s) const;
  Vec3 space_point(double s) const;
  /// Largest distance of the curve from its chord between two parameters, in the plane and in space, mm.
  double sagitta(double s0, double s1) const;

  std::size_t n_segments() const { return plane_.size() - 1; }
  const std::vector<Vec2>& plane() const { return plane_; }
  /// Closest place on one segment. @return its parameter; `distance` in mm.
  double project(std::size_t segment, const Vec2& p, double& distance) const;

 private:
  std::size_t segment_at(double s) const;

  int edge_;
  bool reversed_;
  double length_ = 0;
  std::vector<Vec2> plane_;  // in the edge's own direction
  std::vector<Vec3> space_;
  std::vector<double> share_;  // 0 to 1
};

/// A face as a polygon with holes in its own plane.
struct FaceDomain {
  Vec2 scale{1, 1};  ///< mm per unit of u and v, mean over the face
  /// The plane shows lengths in every direction and place about as they are in space, so that Delaunay there is
  /// Delaunay on the surface.
  bool uniform = true;
  std::vector<std::vector<CoedgeCurve>> loops;  ///< as CadFace::loops
  Vec2 to_plane(const Vec2& uv) const { return {uv[0] * scale[0], uv[1] * scale[1]}; }
};
FaceDomain face_domain(const CadFace& face);

/// A vertex on an edge of the model.
struct ChainNode {
  double s = 0;              ///< share of the edge's length, in its own direction
  std::uint32_t vertex = 0;  ///< of the mesh to be
};

/// The vertices along one edge, from its start to its end.
using EdgeChain = std::vector<ChainNode>;

}  // namespace tri
