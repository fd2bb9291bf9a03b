#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libtri/model/shape.hpp"
#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A CAD model made ready for drawing points on it: its trimmed faces as triangles in (u,v), and the exact surfaces.
///
/// The triangles follow the trimming curves to about 1e-5 of the diagonal; where a trimming curve cuts into a triangle,
/// points close to it are asked one by one.
class SamplingModel {
 public:
  struct Node {
    Vec2 uv;
    Vec3 point;
  };
  struct Facet {
    std::int32_t face = 0;  ///< 0-based position in `faces()`
    std::array<std::uint32_t, 3> nodes{};
    /// For the edges opposite nodes 0, 1, 2: points nearer to the edge than this (mm, measured in scaled (u,v)) may be
    /// trimmed away.
    std::array<float, 3> band{};
  };
  struct Face {
    int index = 0;        ///< 1-based, TopExp::MapShapes order of the shape as given
    Vec2 uv_min, uv_max;  ///< of its nodes
    Vec2 scale{1, 1};     ///< mean length in mm of a unit of u and of v
    std::uint32_t first_facet = 0, facet_count = 0;
  };
  struct Sample {
    Vec3 point;
    Vec3 normal;         ///< unit, outward as the face is oriented in the shape; zero where the surface has no normal
    double stretch = 0;  ///< |du x dv|: mm^2 per unit of the (u,v) plane
  };

  /// Tessellates a copy of `shape`, which stays untouched. @throws CadError if no face can be sampled.
  SamplingModel(const Shape& shape, Context& context);
  ~SamplingModel();

  const std::vector<Face>& faces() const { return faces_; }
  const std::vector<Facet>& facets() const { return facets_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  /// 1-based indices of faces that could not be tessellated and get no point.
  const std::vector<int>& unusable_faces() const { return unusable_faces_; }
  double diagonal() const { return diagonal_; }      ///< mm, of the box of the nodes
  double deflection() const { return deflection_; }  ///< mm, bound on the distance between facets and surface

  /// S(u,v) and its normal. May be called from any thread; each thread has its own evaluators.
  Sample sample(std::int32_t face, const Vec2& uv) const;
  /// True if `uv`, inside `facet`, is not trimmed away. May be called from any thread.
  bool inside(const Facet& facet, const Vec2& uv) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::vector<Face> faces_;
  std::vector<Facet> facets_;
  std::vector<Node> nodes_;
  std::vector<int> unusable_faces_;
  double diagonal_ = 0, deflection_ = 0;
};

}  // namespace tri
