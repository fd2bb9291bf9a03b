#include "meshops/operators/fill_holes.hpp"

#include <algorithm>
#include <cmath>

#include "meshops/add_faces.hpp"
#include "meshops/boundary_loops.hpp"
#include "meshops/polygon_triangulation.hpp"

namespace tri {
namespace {

Vec3 unit(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? v / length : Vec3(0, 0, 0);
}

/// One hole, its rim in the direction in which new triangles run.
class Hole {
 public:
  Hole(MeshView view, const std::vector<HalfedgeHandle>& rim) : view_(view), rim_(rim) {
    for (const HalfedgeHandle h : rim) {
      vertices_.push_back(view.mesh.from_vertex_handle(h));
      points_.push_back(view.point(vertices_.back()));
    }
  }

  const std::vector<VertexHandle>& vertices() const { return vertices_; }
  int size() const { return static_cast<int>(vertices_.size()); }

  bool simple() const {
    std::vector<VertexHandle> sorted = vertices_;
    std::sort(sorted.begin(), sorted.end());
    return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end();
  }

  bool wider_than(double limit) const {
    if (std::isinf(limit)) return false;
    Vec3 low = points_[0], high = points_[0];
    for (const Vec3& p : points_) low.minimize(p), high.maximize(p);
    const Vec3 box = high - low;
    if (box.norm() <= limit) return false;
    if (std::max({box[0], box[1], box[2]}) > limit) return true;
    for (std::size_t i = 0; i < points_.size(); ++i)
      for (std::size_t j = i + 1; j < points_.size(); ++j)
        if ((points_[i] - points_[j]).sqrnorm() > limit * limit) return true;
    return false;
  }

  bool around_single_triangle() const {
    if (size() != 3) return false;
    const auto face = [&](int i) { return view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(rim_[i])); };
    return face(0) == face(1) && face(1) == face(2);
  }

  /// Whether the hole's side faces away from that of the faces at the rim: so it is the outer rim of a sheet, whose triangles would lie
  /// on the sheet's back.
  bool rim_of_sheet() const {
    Vec3 across(0, 0, 0);
    for (std::size_t i = 1; i + 1 < points_.size(); ++i) across += (points_[i] - points_[0]) % (points_[i + 1] - points_[0]);
    across = unit(across);
    double sum = 0, length = 0;
    for (std::size_t i = 0; i < rim_.size(); ++i) {
      const double weight = (points_[(i + 1) % points_.size()] - points_[i]).norm();
      sum += weight * (across | face_normal(view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(rim_[i]))));
      length += weight;
    }
    return sum < -0.5 * length;
  }

  /// The triangles that close it, in the mesh's vertices; empty if there is none without an existing edge.
  std::vector<VertexTriple> triangulate(const FillHolesOptions& options, bool& cut_down) {
    find_forbidden();
    std::vector<RingTriangle> triangles;
    cut_down = false;
    bool done = false;
    if (options.strategy == HoleStrategy::nearest_diagonal) {
      std::vector<std::int32_t> left;
      done = cut_nearest_diagonals(points_, vertex_normals(), chord_test(), 2, triangles, left);
    } else if (size() <= options.max_dynamic_edges) {
      done = triangulate_ring_dihedral_area(points_, edge_normals(), chord_test(), triangles);
    } else {
      cut_down = true;
      done = cut_then_optimise(options.max_dynamic_edges, triangles);
    }
    std::vector<VertexTriple> result;
    if (!done) return result;
    for (const RingTriangle& t : triangles) result.push_back({vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]});
    return result;
  }

 private:
  /// Pairs of rim vertices that are joined by an edge of the mesh which is not of the rim.
  void find_forbidden() {
    std::vector<std::pair<int, int>> place;  // (vertex, position in the ring)
    for (int i = 0; i < size(); ++i) place.push_back({vertices_[i].idx(), i});
    std::sort(place.begin(), place.end());
    for (int i = 0; i < size(); ++i)
      for (auto it = view_.mesh.cvv_iter(vertices_[i]); it.is_valid(); ++it) {
        const auto found = std::lower_bound(place.begin(), place.end(), std::pair((*it).idx(), 0));
        if (found == place.end() || found->first != (*it).idx()) continue;
        const int j = found->second;
        if (j > i + 1 && !(i == 0 && j == size() - 1)) forbidden_.push_back({i, j});
      }
    std::sort(forbidden_.begin(), forbidden_.end());
  }

  std::function<bool(int, int)> chord_test() const {
    if (forbidden_.empty()) return {};
    return [this](int i, int j) { return !std::binary_search(forbidden_.begin(), forbidden_.end(), std::pair(i, j)); };
  }

  Vec3 face_normal(FaceHandle f) const {
    const HalfedgeHandle h = view_.mesh.halfedge_handle(f);
    const Vec3& a = view_.point(view_.mesh.from_vertex_handle(h));
    const Vec3& b = view_.point(view_.mesh.to_vertex_handle(h));
    const Vec3& c = view_.point(view_.mesh.to_vertex_handle(view_.mesh.next_halfedge_handle(h)));
    return unit((b - a) % (c - a));
  }

  std::vector<Vec3> edge_normals() const {
    std::vector<Vec3> normals;
    for (const HalfedgeHandle h : rim_) normals.push_back(face_normal(view_.mesh.face_handle(view_.mesh.opposite_halfedge_handle(h))));
    return normals;
  }

  std::vector<Vec3> vertex_normals() const {
    std::vector<Vec3> normals;
    for (const VertexHandle v : vertices_) {
      Vec3 sum(0, 0, 0);
      for (auto it = view_.mesh.cvf_iter(v); it.is_valid(); ++it) sum += face_normal(*it);
      normals.push_back(unit(sum));
    }
    return normals;
  }

  bool cut_then_optimise(int rest, std::vector<RingTriangle>& triangles) const {
    std::vector<std::int32_t> left;
    if (!cut_nearest_diagonals(points_, vertex_normals(), chord_test(), rest, triangles, left)) return false;
    const int m = static_cast<int>(left.size());
    // Beyond each edge of the smaller ring lies a triangle that was cut, or the mesh.
    std::vector<Vec3> points, normals;
    const std::vector<Vec3> mesh_normals = edge_normals();
    for (int i = 0; i < m; ++i) {
      points.push_back(points_[left[i]]);
      const int next = left[(i + 1) % m];
      normals.push_back(next == (left[i] + 1) % size() ? mesh_normals[left[i]] : Vec3(0, 0, 0));
    }
    for (const RingTriangle& t : triangles) {  // an ear (p, b, r) leaves the edge p -> r
      const auto at = std::lower_bound(left.begin(), left.end(), t[0]);
      if (at == left.end() || *at != t[0]) continue;
      const int i = static_cast<int>(at - left.begin());
      if (left[(i + 1) % m] == t[2]) normals[i] = unit((points_[t[1]] - points_[t[0]]) % (points_[t[2]] - points_[t[0]]));
    }
    std::function<bool(int, int)> allowed;
    if (!forbidden_.empty())
      allowed = [&](int i, int j) { return !std::binary_search(forbidden_.begin(), forbidden_.end(), std::pair(left[i], left[j])); };
    std::vector<RingTriangle> inner;
    if (!triangulate_ring_dihedral_area(points, normals, allowed, inner)) return false;
    for (const RingTriangle& t : inner) triangles.push_back({left[t[0]], left[t[1]], left[t[2]]});
    return true;
  }

  MeshView view_;
  const std::vector<HalfedgeHandle>& rim_;
  std::vector<VertexHandle> vertices_;
  std::vector<Vec3> points_;
  std::vector<std::pair<int, int>> forbidden_;
};

}  // namespace

const OptionSchema& FillHolesOptions::schema() {
  using O = FillHolesOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("strategy", &O::strategy,
                  {{"nearest-diagonal", HoleStrategy::nearest_diagonal}, {"minimum-area-dihedral", HoleStrategy::minimum_area_dihedral}},
                  {.help = "how a hole is triangulated"})
          .integer("max-edges", &O::max_edges, {.unit = "edges", .min = 3, .help = "loops with more edges stay open"})
          .number("max-diameter", &O::max_diameter,
                  {.unit = "mm", .min = 0, .infinite = true, .help = "loops with two vertices farther apart stay open"})
          .integer("max-dynamic-edges", &O::max_dynamic_edges,
                   {.unit = "edges", .min = 3, .max = 1000,
                    .help = "longer loops are first cut down to this many edges by nearest diagonals"});
  return schema;
}

Report fill_holes(MeshView view, const FillHolesOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  Report report;
  report.operation = "fill-holes";
  double filled = 0, cut = 0;
  const auto cycles = boundary_cycles(view);
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    context.checkpoint();
    context.progress("fill-holes", static_cast<double>(i) / static_cast<double>(cycles.size()));
    Hole hole(view, cycles[i]);
    const auto skip = [&](const char* reason) { ++report.skipped[reason]; };
    if (hole.size() > options.max_edges) {
      skip("loop longer than max-edges");
    } else if (hole.wider_than(options.max_diameter)) {
      skip("loop wider than max-diameter");
    } else if (!hole.simple()) {
      skip("loop meets itself in a vertex");
    } else if (hole.around_single_triangle()) {
      skip("rim of a single triangle");
    } else if (hole.rim_of_sheet()) {
      skip("rim of a sheet");
    } else if (options.reference && options.reference->keeps_open(hole.vertices())) {
      skip("kept open by the reference");
    } else {
      bool cut_down = false;
      const std::vector<VertexTriple> triangles = hole.triangulate(options, cut_down);
      std::vector<FaceHandle> added;
      if (triangles.empty() || add_faces(view, triangles, &added) != FitResult::fits) {
        skip("no triangulation without an existing edge");
        continue;
      }
      ++filled;
      cut += cut_down;
      report.faces_added += added.size();
      for (const FaceHandle f : added) report.touched_faces.push_back(static_cast<std::uint32_t>(f.idx()));
      for (const VertexHandle v : hole.vertices()) report.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
    }
  }
  if (!cycles.empty()) context.progress("fill-holes", 1);
  if (filled > 0) report.figures["holes filled"] = filled;
  if (cut > 0) report.figures["holes cut down first"] = cut;
  return report;
}

}  // namespace tri
