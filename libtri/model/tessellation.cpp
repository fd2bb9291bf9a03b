#include "libtri/model/tessellation.hpp"

#include <tbb/task_arena.h>

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <unordered_map>

#include "libtri/model/shape_occt.hpp"
#include "meshops/error.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/disjoint_sets.hpp"

namespace tri {
namespace {

/// One side of a triangle: the edge opposite `corner`.
struct Side {
  std::int32_t triangle = -1;
  int corner = 0;
};

/// Per triangle and side, the side on the other face of the edge. Sides, not only triangles: around a pole two
/// triangles can share two edges.
using Twins = std::vector<std::array<Side, 3>>;

std::uint64_t directed(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{from} << 32 | to;
}

/// The triangulations of all faces side by side, linked within each face; nodes are not shared between faces yet.
struct LooseFaces {
  struct Use {                         // of a model edge by a face
    std::vector<std::uint32_t> nodes;  // in the edge's own direction
  };
  std::vector<Vec3> nodes;
  std::vector<Vec2> node_uv;
  std::vector<Triangle> triangles;
  std::vector<std::int32_t> faces;
  std::vector<std::vector<Use>> edge_uses;        // by 1-based edge number; degenerate edges have none
  std::vector<std::vector<std::uint32_t>> poles;  // nodes of each degenerate edge
};

std::vector<std::uint32_t> polygon_nodes(const Handle(Poly_PolygonOnTriangulation) & polygon, std::uint32_t offset) {
  std::vector<std::uint32_t> nodes;
  nodes.reserve(static_cast<std::size_t>(polygon->NbNodes()));
  for (int k = 1; k <= polygon->NbNodes(); ++k)
    nodes.push_back(offset + static_cast<std::uint32_t>(polygon->Node(k)) - 1);
  return nodes;
}

LooseFaces collect(const CadModel& model) {
  const TopoDS_Shape& shape = occt(model.shape);
  TopTools_IndexedMapOfShape face_map, edge_map;
  TopExp::MapShapes(shape, TopAbs_FACE, face_map);
  TopExp::MapShapes(shape, TopAbs_EDGE, edge_map);
  LooseFaces loose;
  loose.edge_uses.resize(static_cast<std::size_t>(edge_map.Extent()) + 1);
  for (std::size_t position = 0; position < model.faces.size(); ++position) {
    const TopoDS_Face face = TopoDS::Face(face_map(model.faces[position].shape_face));
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull()) continue;
    const auto offset = static_cast<std::uint32_t>(loose.nodes.size());
    for (int k = 1; k <= mesh->NbNodes(); ++k) {
      const gp_Pnt p = mesh->Node(k).Transformed(location);
      const gp_Pnt2d q = mesh->UVNode(k);
      loose.nodes.emplace_back(p.X(), p.Y(), p.Z());
      loose.node_uv.emplace_back(q.X(), q.Y());
    }
    const bool reversed = face.Orientation() == TopAbs_REVERSED;
    for (int k = 1; k <= mesh->NbTriangles(); ++k) {
      int a, b, c;
      mesh->Triangle(k).Get(a, b, c);
      if (reversed) std::swap(b, c);
      loose.triangles.push_back({offset + static_cast<std::uint32_t>(a) - 1, offset + static_cast<std::uint32_t>(b) - 1,
                                 offset + static_cast<std::uint32_t>(c) - 1});
      loose.faces.push_back(static_cast<std::int32_t>(position));
    }
    const auto add_use = [&](const TopoDS_Edge& edge, const Handle(Poly_PolygonOnTriangulation) & polygon) {
      if (polygon.IsNull()) return;
      if (BRep_Tool::Degenerated(edge)) {
        loose.poles.push_back(polygon_nodes(polygon, offset));
      } else {
        loose.edge_uses[static_cast<std::size_t>(edge_map.FindIndex(edge))].push_back({polygon_nodes(polygon, offset)});
      }
    };
    TopTools_IndexedMapOfShape face_edges;
    TopExp::MapShapes(face, TopAbs_EDGE, face_edges);
    for (int e = 1; e <= face_edges.Extent(); ++e) {
      const TopoDS_Edge edge = TopoDS::Edge(face_edges(e));
      add_use(edge, BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), mesh, location));
      if (BRep_Tool::IsClosed(edge, mesh, location))
        add_use(edge, BRep_Tool::PolygonOnTriangulation(TopoDS::Edge(edge.Oriented(TopAbs_REVERSED)), mesh, location));
    }
  }
  return loose;
}

/// Links triangles within each face by their nodes, and across each model edge segment by segment.
Twins link(const LooseFaces& loose) {
  Twins twins(loose.triangles.size());
  std::unordered_map<std::uint64_t, Side> sides;
  sides.reserve(loose.triangles.size() * 3);
  for (std::size_t t = 0; t < loose.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      sides.emplace(directed(loose.triangles[t][(k + 1) % 3], loose.triangles[t][(k + 2) % 3]),
                    Side{static_cast<std::int32_t>(t), k});
  for (std::size_t t = 0; t < loose.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto twin = sides.find(directed(loose.triangles[t][(k + 2) % 3], loose.triangles[t][(k + 1) % 3]));
      if (twin != sides.end()) twins[t][k] = twin->second;
    }
  for (const auto& uses : loose.edge_uses) {
    if (uses.size() != 2 || uses[0].nodes.size() != uses[1].nodes.size())
      continue;  // free, non-manifold, or out of step
    for (std::size_t k = 0; k + 1 < uses[0].nodes.size(); ++k) {
      Side found[2];
      bool along[2] = {false, false};
      for (int i = 0; i < 2; ++i) {
        const std::uint32_t a = uses[i].nodes[k], b = uses[i].nodes[k + 1];
        auto side = sides.find(directed(a, b));
        along[i] = side != sides.end();
        if (!along[i]) side = sides.find(directed(b, a));
        if (side != sides.end()) found[i] = side->second;
      }
      if (found[0].triangle < 0 || found[1].triangle < 0 || along[0] == along[1]) continue;
      twins[found[0].triangle][found[0].corner] = found[1];
      twins[found[1].triangle][found[1].corner] = found[0];
    }
  }
  return twins;
}

// OpenCASCADE is not instrumented: the sanitizer does not see what orders its threads.
#if defined(__SANITIZE_THREAD__)
constexpr bool faces_in_parallel = false;
#else
constexpr bool faces_in_parallel = true;
#endif

}  // namespace

Tessellation tessellate(const CadModel& model, double deflection, double angle, const Context& context) {
  context.checkpoint();
  tbb::task_arena(worker_threads(context)).execute([&] {
    BRepMesh_IncrementalMesh(occt(model.shape), deflection, false, angle, faces_in_parallel);
  });
  LooseFaces loose = collect(model);
  if (loose.triangles.empty()) throw CadError("no face of the model could be tessellated");
  Twins twins = link(loose);

  // A triangle with two nodes on one pole has no area: its two other neighbours become each other's.
  std::vector<std::int32_t> pole_of(loose.nodes.size(), -1);
  for (std::size_t p = 0; p < loose.poles.size(); ++p)
    for (std::uint32_t node : loose.poles[p]) pole_of[node] = static_cast<std::int32_t>(p);
  std::vector<bool> dropped(loose.triangles.size(), false);
  const auto relink = [&](const Side& side, const Side& to) {
    if (side.triangle >= 0) twins[side.triangle][side.corner] = to;
  };
  for (std::size_t t = 0; t < loose.triangles.size(); ++t)
    for (int k = 0; k < 3 && !dropped[t]; ++k) {
      const std::int32_t a = pole_of[loose.triangles[t][(k + 1) % 3]], b = pole_of[loose.triangles[t][(k + 2) % 3]];
      if (a < 0 || a != b) continue;
      dropped[t] = true;
      const Side left = twins[t][(k + 1) % 3], right = twins[t][(k + 2) % 3];
      relink(left, right);
      relink(right, left);
    }

  // A vertex is a fan of triangle corners connected across links.
  DisjointSets corners(loose.triangles.size() * 3);
  for (std::uint32_t t = 0; t < loose.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Side& n = twins[t][k];
      if (dropped[t] || n.triangle < 0) continue;
      if (n.triangle == static_cast<std::int32_t>(t)) {  // one triangle all around a pole: cut open
        twins[t][k] = {};
        continue;
      }
      const auto other = 3 * static_cast<std::uint32_t>(n.triangle);
      corners.join(3 * t + (k + 1) % 3, other + (n.corner + 2) % 3);
      corners.join(3 * t + (k + 2) % 3, other + (n.corner + 1) % 3);
    }

  Tessellation result;
  result.deflection = deflection;
  std::vector<std::int32_t> vertex(loose.triangles.size() * 3, -1), renumbered(loose.triangles.size(), -1);
  for (std::uint32_t t = 0; t < loose.triangles.size(); ++t) {
    if (dropped[t]) continue;
    renumbered[t] = static_cast<std::int32_t>(result.triangles.size());
    Triangle corner_vertices;
    std::array<Vec2, 3> uv;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t root = corners.find(3 * t + k);
      if (vertex[root] < 0) {
        vertex[root] = static_cast<std::int32_t>(result.points.size());
        result.points.push_back(loose.nodes[loose.triangles[root / 3][root % 3]]);
      }
      corner_vertices[k] = static_cast<std::uint32_t>(vertex[root]);
      uv[k] = loose.node_uv[loose.triangles[t][k]];
    }
    result.triangles.push_back(corner_vertices);
    result.corner_uv.push_back(uv);
    result.faces.push_back(loose.faces[t]);
    result.neighbors.push_back({twins[t][0].triangle, twins[t][1].triangle, twins[t][2].triangle});
  }
  for (auto& row : result.neighbors)
    for (std::int32_t& n : row)
      if (n >= 0) n = renumbered[n];
  return result;
}

SurfaceTopology topology(const std::vector<Triangle>& triangles,
                         const std::vector<std::array<std::int32_t, 3>>& neighbors, const Context* context) {
  Pace pace(context);
  std::uint32_t vertices = 0;
  for (const Triangle& t : triangles)
    for (std::uint32_t v : t) vertices = std::max(vertices, v + 1);
  std::vector<bool> used(vertices, false);
  DisjointSets components(triangles.size()), rims(vertices);
  std::vector<bool> on_rim(vertices, false);
  long edges_twice = 0;
  for (std::uint32_t i = 0; i < triangles.size(); ++i, pace())
    for (int k = 0; k < 3; ++k) {
      used[triangles[i][k]] = true;
      if (neighbors[i][k] >= 0) {
        if (neighbors[i][k] > static_cast<std::int32_t>(i))
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
  for (std::uint32_t v = 0; v < vertices; ++v, pace()) {
    n_vertices += used[v];
    if (on_rim[v] && rims.find(v) == v) ++result.loops;
  }
  for (std::uint32_t i = 0; i < triangles.size(); ++i, pace())
    if (components.find(i) == i) ++result.components;
  result.euler = n_vertices - edges_twice / 2 + static_cast<long>(triangles.size());
  return result;
}

}  // namespace tri
