#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>
#include <vector>

#include "libtri/triangulation/point_mesh.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// Triangles around each vertex, ascending, as one array with offsets.
struct MeshStars {
  std::vector<std::uint32_t> start, items;
  MeshStars(std::span<const Triangle> triangles, std::size_t vertices);
  std::span<const std::uint32_t> of(std::uint32_t v) const {
    return {items.data() + start[v], items.data() + start[v + 1]};
  }
};

/// Lengths of a triangle, in the unit of the places.
struct TriangleShape {
  float circumradius = 0;  ///< at most `longest`: a needle's circumcircle says nothing about the points around it
  float longest = 0, shortest = 0;  ///< edges
};

/// The spacing of points around each vertex of a mesh through them: on scattered points about the square root of the
/// area per point, on scan lines the distance of the lines. Taken from the radii of the circumcircles, which the dense
/// direction does not shrink.
///
/// Built on the threads of the caller's arena; may be asked from several threads at once.
class MeshSpacing {
 public:
  /// @param mesh, places  are referred to. One place per point.
  MeshSpacing(const PointMesh& mesh, std::span<const Vec3> places);

  /// The median over some forty vertices around, on scan lines up to four hundred, so that those at the rim of a gap
  /// know it as well as any; 0 for a point in no triangle.
  float at(std::uint32_t v) const;
  /// The largest of a triangle's corners.
  float at(const Triangle& t) const;
  /// A cheap value that hardly ever is above `at(t)`.
  float lowest(const Triangle& t) const;

  const TriangleShape& shape(std::uint32_t t) const { return shapes_[t]; }
  const MeshStars& stars() const { return stars_; }

 private:
  const PointMesh& mesh_;
  std::vector<TriangleShape> shapes_;
  MeshStars stars_;
  std::vector<float> own_, lowest_;
  std::vector<float> ratio_;  // small on scan lines: the median around a vertex of shortest edge over circumradius
  struct Scratch {
    std::vector<std::uint32_t> queue, seen;  // seen: the last round that met the vertex
    std::vector<float> values;
    std::uint32_t round = 0;
  };
  mutable tbb::enumerable_thread_specific<Scratch> scratch_;
  mutable std::vector<float> around_;  // -1 until asked; written as atomics, always with the same value
};

}  // namespace tri
