#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meshops/mesh_view.hpp"

namespace tri {

/// The triangles around the two ends of an edge that is to be collapsed, and whether the surface stays the same.
class CollapseStars {
 public:
  /// The two corners of a triangle at one end of the edge, besides that end, in the triangle's direction.
  using Side = std::array<VertexHandle, 2>;

  explicit CollapseStars(const OpenMesh::TriConnectivity& mesh) : mesh_(mesh) {}

  /// Looks at the edge of a half-edge, which is not deleted. Memory is used again from call to call.
  void look_at(HalfedgeHandle h) {
    halfedge_ = h;
    look_around(h, 0);
    look_around(mesh_.opposite_halfedge_handle(h), 1);
  }

  /// The triangles at the start (0) or end (1) of the half-edge that have not both ends, in turn.
  const std::vector<Side>& fan(int end) const { return fans_[end]; }

  /// Whether the collapse keeps the topology [Dey, Edelsbrunner, Guha & Nekhayev 1999] and leaves a valid half-edge
  /// mesh: only the triangles at the edge have both ends for neighbours.
  /// @param on_line  whether an edge lies on a line that must stay one, boundary edges among them: no triangle may go
  ///                 whose other two sides do
  template <class OnLine>
  bool keeps_topology(const OnLine& on_line) {
    std::size_t sides = 0;
    for (const HalfedgeHandle g : {halfedge_, mesh_.opposite_halfedge_handle(halfedge_)}) {
      if (mesh_.is_boundary(g)) continue;
      ++sides;
      if (on_line(mesh_.edge_handle(mesh_.next_halfedge_handle(g))) &&
          on_line(mesh_.edge_handle(mesh_.prev_halfedge_handle(g))))
        return false;
    }
    if (stamps_.size() < mesh_.n_vertices()) stamps_.resize(mesh_.n_vertices() + mesh_.n_vertices() / 2, 0);
    ++stamp_;
    for (const VertexHandle v : neighbours_[0]) stamps_[static_cast<std::size_t>(v.idx())] = stamp_;
    std::size_t common = 0;
    for (const VertexHandle v : neighbours_[1]) common += stamps_[static_cast<std::size_t>(v.idx())] == stamp_;
    if (common != sides) return false;
    return sides != 2 || neighbours_[0].size() != 3 || neighbours_[1].size() != 3;  // a tetrahedron
  }

 private:
  void look_around(HalfedgeHandle first, int end) {
    std::vector<Side>& fan = fans_[end];
    std::vector<VertexHandle>& neighbours = neighbours_[end];
    fan.clear();
    neighbours.clear();
    const HalfedgeHandle last = mesh_.opposite_halfedge_handle(first);
    HalfedgeHandle h = first;
    do {
      neighbours.push_back(mesh_.to_vertex_handle(h));
      const HalfedgeHandle back = mesh_.prev_halfedge_handle(h);
      // The first and the last triangle lie at the edge.
      if (h != first && back != last && !mesh_.is_boundary(h))
        fan.push_back({neighbours.back(), mesh_.from_vertex_handle(back)});
      h = mesh_.opposite_halfedge_handle(back);
    } while (h != first);
  }

  const OpenMesh::TriConnectivity& mesh_;
  HalfedgeHandle halfedge_;
  std::array<std::vector<Side>, 2> fans_;
  std::array<std::vector<VertexHandle>, 2> neighbours_;
  std::vector<std::uint32_t> stamps_;  // per vertex: the last look in which it was a neighbour of the start
  std::uint32_t stamp_ = 0;
};

}  // namespace tri
