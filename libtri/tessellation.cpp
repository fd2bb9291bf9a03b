#include "libtri/tessellation.hpp"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <numeric>

#include "libtri/shape_occt.hpp"
#include "libtri/triangle_links.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Nodes of one edge's polygon on one face, in the edge's own direction, numbered from `offset`.
std::vector<std::uint32_t> edge_nodes(const Handle(Poly_PolygonOnTriangulation)& polygon, std::uint32_t offset) {
  std::vector<std::uint32_t> nodes;
  nodes.reserve(static_cast<std::size_t>(polygon->NbNodes()));
  for (int k = 1; k <= polygon->NbNodes(); ++k) nodes.push_back(offset + static_cast<std::uint32_t>(polygon->Node(k)) - 1);
  return nodes;
}

}  // namespace

Tessellation tessellate(const CadModel& model, double deflection, double angle, const Context& context) {
  context.checkpoint();
  const TopoDS_Shape& shape = occt(model.shape);
  BRepMesh_IncrementalMesh(shape, deflection, false, angle, true);

  TopTools_IndexedMapOfShape face_map, edge_map;
  TopExp::MapShapes(shape, TopAbs_FACE, face_map);
  TopExp::MapShapes(shape, TopAbs_EDGE, edge_map);

  std::vector<Vec3> nodes;
  std::vector<Vec2> node_uv;
  struct FaceMesh {
    TopoDS_Face face;
    TopLoc_Location location;
    Handle(Poly_Triangulation) triangulation;
    std::uint32_t offset;
    int position;  // in CadModel::faces
  };
  std::vector<FaceMesh> face_meshes;
  for (std::size_t position = 0; position < model.faces.size(); ++position) {
    FaceMesh m;
    m.face = TopoDS::Face(face_map(model.faces[position].shape_face));
    m.triangulation = BRep_Tool::Triangulation(m.face, m.location);
    m.offset = static_cast<std::uint32_t>(nodes.size());
    m.position = static_cast<int>(position);
    if (m.triangulation.IsNull()) continue;
    for (int k = 1; k <= m.triangulation->NbNodes(); ++k) {
      const gp_Pnt p = m.triangulation->Node(k).Transformed(m.location);
      const gp_Pnt2d q = m.triangulation->UVNode(k);
      nodes.emplace_back(p.X(), p.Y(), p.Z());
      node_uv.emplace_back(q.X(), q.Y());
    }
    face_meshes.push_back(m);
  }
  if (face_meshes.empty()) throw CadError("no face of the model could be tessellated");

  DisjointSets merged(nodes.size());
  std::vector<std::vector<std::uint32_t>> first_use(static_cast<std::size_t>(edge_map.Extent()) + 1);
  const auto merge_edge = [&](const TopoDS_Edge& edge, const std::vector<std::uint32_t>& ids) {
    if (BRep_Tool::Degenerated(edge)) {
      for (std::uint32_t id : ids) merged.join(id, ids.front());
      return;
    }
    auto& first = first_use[static_cast<std::size_t>(edge_map.FindIndex(edge))];
    if (first.empty()) {
      first = ids;
    } else if (first.size() == ids.size()) {
      for (std::size_t k = 0; k < ids.size(); ++k) merged.join(ids[k], first[k]);
    }
  };
  for (const FaceMesh& m : face_meshes)
    for (TopExp_Explorer it(m.face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge edge = TopoDS::Edge(it.Current());
      const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
      const auto polygon = BRep_Tool::PolygonOnTriangulation(forward, m.triangulation, m.location);
      if (!polygon.IsNull()) merge_edge(edge, edge_nodes(polygon, m.offset));
      if (!BRep_Tool::IsClosed(edge, m.triangulation, m.location)) continue;
      const TopoDS_Edge reversed = TopoDS::Edge(edge.Oriented(TopAbs_REVERSED));
      const auto other = BRep_Tool::PolygonOnTriangulation(reversed, m.triangulation, m.location);
      if (!other.IsNull()) merge_edge(edge, edge_nodes(other, m.offset));
    }

  Tessellation result;
  result.deflection = deflection;
  std::vector<std::int64_t> id(nodes.size(), -1);
  for (std::uint32_t k = 0; k < nodes.size(); ++k) {
    const std::uint32_t root = merged.find(k);
    if (id[root] < 0) {
      id[root] = static_cast<std::int64_t>(result.points.size());
      result.points.push_back(nodes[root]);
    }
    id[k] = id[root];
  }
  for (const FaceMesh& m : face_meshes) {
    const bool reversed = m.face.Orientation() == TopAbs_REVERSED;
    for (int k = 1; k <= m.triangulation->NbTriangles(); ++k) {
      int a, b, c;
      m.triangulation->Triangle(k).Get(a, b, c);
      if (reversed) std::swap(b, c);
      const std::array<std::uint32_t, 3> n{m.offset + static_cast<std::uint32_t>(a) - 1, m.offset + static_cast<std::uint32_t>(b) - 1,
                                           m.offset + static_cast<std::uint32_t>(c) - 1};
      const Triangle t{static_cast<std::uint32_t>(id[n[0]]), static_cast<std::uint32_t>(id[n[1]]), static_cast<std::uint32_t>(id[n[2]])};
      if (t[0] == t[1] || t[1] == t[2] || t[0] == t[2]) continue;  // the tip of a pole: no area
      result.triangles.push_back(t);
      result.faces.push_back(m.position);
      result.corner_uv.push_back({node_uv[n[0]], node_uv[n[1]], node_uv[n[2]]});
    }
  }
  result.neighbors = link_triangles(result.triangles, result.points.size());
  for (std::uint32_t source : split_fans(result.triangles, result.neighbors, result.points.size()))
    result.points.push_back(result.points[source]);
  return result;
}

SurfaceTopology topology(const std::vector<Triangle>& triangles, const std::vector<std::array<std::int32_t, 3>>& neighbors) {
  std::uint32_t vertices = 0;
  for (const Triangle& t : triangles)
    for (std::uint32_t v : t) vertices = std::max(vertices, v + 1);
  std::vector<bool> used(vertices, false);
  DisjointSets components(triangles.size()), rims(vertices);
  std::vector<bool> on_rim(vertices, false);
  long edges_twice = 0;
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      used[triangles[i][k]] = true;
      if (neighbors[i][k] >= 0) {
        components.join(i, static_cast<std::uint32_t>(neighbors[i][k]));
        edges_twice += 1;
      } else {
        const std::uint32_t a = triangles[i][(k + 1) % 3], b = triangles[i][(k + 2) % 3];
        on_rim[a] = on_rim[b] = true;
        rims.join(a, b);
        edges_twice += 2;
      }
    }
  SurfaceTopology result;
  long n_vertices = 0;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    n_vertices += used[v];
    if (on_rim[v] && rims.find(v) == v) ++result.loops;
  }
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    if (components.find(i) == i) ++result.components;
  result.euler = n_vertices - edges_twice / 2 + static_cast<long>(triangles.size());
  return result;
}

}  // namespace tri
