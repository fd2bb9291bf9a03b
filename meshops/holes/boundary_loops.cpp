#include "meshops/holes/boundary_loops.hpp"

#include "meshops/pace.hpp"

namespace tri {
namespace {

bool is_live_boundary(const OpenMesh::TriConnectivity& mesh, HalfedgeHandle h) {
  return mesh.is_boundary(h) && !mesh.status(mesh.edge_handle(h)).deleted() &&
         mesh.face_handle(mesh.opposite_halfedge_handle(h)).is_valid();
}

Vec3 vector_area(const std::vector<Vec3>& ring) {
  Vec3 sum(0, 0, 0);
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) sum += 0.5 * ((ring[i] - ring[0]) % (ring[i + 1] - ring[0]));
  return sum;
}

}  // namespace

std::vector<std::vector<HalfedgeHandle>> boundary_cycles(MeshView view, const Context* context) {
  Pace pace(context);
  const auto& mesh = view.mesh;
  std::vector<std::vector<HalfedgeHandle>> cycles;
  std::vector<char> seen(mesh.n_halfedges(), 0);
  for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i, pace()) {
    const HalfedgeHandle start(i);
    if (seen[i] || !is_live_boundary(mesh, start)) continue;
    auto& cycle = cycles.emplace_back();
    HalfedgeHandle h = start;
    do {
      seen[h.idx()] = 1;
      cycle.push_back(h);
      h = mesh.next_halfedge_handle(h);
    } while (h != start);
  }
  return cycles;
}

std::vector<int> face_components(MeshView view, const Context* context) {
  Pace pace(context);
  const auto& mesh = view.mesh;
  std::vector<int> component(mesh.n_faces(), -1);
  std::vector<FaceHandle> stack;
  int count = 0;
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i, pace()) {
    if (component[i] >= 0 || mesh.status(FaceHandle(i)).deleted()) continue;
    component[i] = count;
    stack.push_back(FaceHandle(i));
    while (!stack.empty()) {
      pace();
      const FaceHandle f = stack.back();
      stack.pop_back();
      HalfedgeHandle h = mesh.halfedge_handle(f);
      for (int k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
        const FaceHandle g = mesh.face_handle(mesh.opposite_halfedge_handle(h));
        if (!g.is_valid() || component[g.idx()] >= 0) continue;
        component[g.idx()] = count;
        stack.push_back(g);
      }
    }
    ++count;
  }
  return component;
}

std::vector<std::size_t> component_sizes(MeshView view, const Context* context) {
  const std::vector<int> component = face_components(view, context);
  std::vector<std::size_t> count(component.size() + 1, 0), result(component.size(), 0);
  for (const int c : component)
    if (c >= 0) ++count[c];
  for (std::size_t i = 0; i < component.size(); ++i)
    if (component[i] >= 0) result[i] = count[component[i]];
  return result;
}

std::vector<BoundaryLoop> boundary_loops(MeshView view, const Context* context) {
  Pace pace(context);
  const auto& mesh = view.mesh;
  std::vector<BoundaryLoop> loops;
  auto cycles = boundary_cycles(view, context);
  if (cycles.empty()) return loops;

  const std::vector<int> component = face_components(view, context);
  int components = 0;
  for (const int c : component) components = std::max(components, c + 1);
  std::vector<Vec3> normal(components, Vec3(0, 0, 0));
  std::vector<double> area(components, 0);
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i, pace()) {
    if (component[i] < 0) continue;
    const HalfedgeHandle h = mesh.halfedge_handle(FaceHandle(i));
    const Vec3& a = view.point(mesh.from_vertex_handle(h));
    const Vec3& b = view.point(mesh.to_vertex_handle(h));
    const Vec3& c = view.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(h)));
    const Vec3 n = 0.5 * ((b - a) % (c - a));
    normal[component[i]] += n;
    area[component[i]] += n.norm();
  }

  std::vector<int> last_loop(mesh.n_vertices(), -1), outer(components, -1);
  std::vector<double> reach(components, 0);
  for (auto& cycle : cycles) {
    const int index = static_cast<int>(loops.size());
    BoundaryLoop& loop = loops.emplace_back();
    loop.halfedges = std::move(cycle);
    loop.polyline.reserve(loop.halfedges.size());
    for (const HalfedgeHandle h : loop.halfedges) {
      const VertexHandle v = mesh.from_vertex_handle(h);
      if (last_loop[v.idx()] == index) loop.simple = false;
      last_loop[v.idx()] = index;
      loop.polyline.push_back(view.point(v));
      loop.length += (view.point(mesh.to_vertex_handle(h)) - view.point(v)).norm();
    }
    const int c = component[mesh.face_handle(mesh.opposite_halfedge_handle(loop.halfedges.front())).idx()];
    loop.component = c;
    // Boundary half-edges run against the faces, hence the sign.
    const bool sheet = normal[c].norm() > 1e-6 * area[c];
    const double own = sheet ? -(vector_area(loop.polyline) | normal[c]) : loop.length;
    if (outer[c] < 0 || own > reach[c]) {
      outer[c] = index;
      reach[c] = own;
    }
  }
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const int o = outer[loops[i].component];
    loops[i].outer = o == static_cast<int>(i);
    loops[i].parent = loops[i].outer ? -1 : o;
  }
  return loops;
}

}  // namespace tri
