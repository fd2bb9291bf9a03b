#include "meshops/holes/refine_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "meshops/editing/mesh_edit.hpp"
#include "meshops/shape/triangle_normal.hpp"

namespace tri {
namespace {

class Refiner {
 public:
  Refiner(MeshView view, std::vector<FaceHandle>& faces, double growth,
          const std::function<int(const VertexTriple&)>& crossings, const Context& context)
      : view_(view), mesh_(view.mesh), faces_(faces), growth_(growth), crossings_(crossings), context_(context) {
    for (const FaceHandle f : faces) inside_.insert(f.idx());
    for (const FaceHandle f : faces)
      for (auto it = mesh_.cfv_iter(f); it.is_valid(); ++it)
        if (!size_.count((*it).idx())) size_[(*it).idx()] = outer_length(*it);
  }

  std::vector<VertexHandle> run() {
    relax_all();
    // Each pass splits what is too large; each halves the triangles' size at least every other time.
    for (int pass = 0; pass < 100; ++pass) {
      const std::size_t before = faces_.size();
      for (std::size_t i = 0; i < before; ++i) {
        if (i % 256 == 0) context_.checkpoint();
        split_if_large(faces_[i]);
      }
      if (faces_.size() == before) break;
      relax_all();
    }
    return std::move(added_);
  }

 private:
  double outer_length(VertexHandle v) const {
    double sum = 0, all = 0;
    int count = 0, degree = 0;
    for (auto it = mesh_.cvoh_iter(v); it.is_valid(); ++it) {
      const double length = (view_.point(mesh_.to_vertex_handle(*it)) - view_.point(v)).norm();
      all += length;
      ++degree;
      if (!outside(*it) && !outside(mesh_.opposite_halfedge_handle(*it))) continue;
      sum += length;
      ++count;
    }
    return count > 0 ? sum / count : all / degree;
  }
  bool outside(HalfedgeHandle h) const {
    const FaceHandle f = mesh_.face_handle(h);
    return f.is_valid() && !inside_.count(f.idx());
  }

  void split_if_large(FaceHandle f) {
    VertexHandle corner[3];
    int n = 0;
    for (auto it = mesh_.cfv_iter(f); it.is_valid(); ++it) corner[n++] = *it;
    const Vec3 middle = (view_.point(corner[0]) + view_.point(corner[1]) + view_.point(corner[2])) / 3;
    double mean = 0, bound = std::numeric_limits<double>::infinity(), distance[3];
    for (int k = 0; k < 3; ++k) {
      const double size = size_.at(corner[k].idx());
      distance[k] = (view_.point(corner[k]) - middle).norm();
      mean += (size + growth_ * distance[k]) / 3;
      bound = std::min(bound, size + (growth_ + 0.5) * distance[k]);
    }
    const double size = std::min(mean, bound);
    for (int k = 0; k < 3; ++k)
      if (!(std::sqrt(2.0) * distance[k] > std::max(size, size_.at(corner[k].idx())))) return;
    const VertexHandle v = split_face(view_, f, middle, {1.0 / 3, 1.0 / 3, 1.0 / 3});
    size_[v.idx()] = size;
    added_.push_back(v);
    for (auto it = mesh_.cvoh_iter(v); it.is_valid(); ++it) {
      const FaceHandle piece = mesh_.face_handle(*it);
      if (inside_.insert(piece.idx()).second) faces_.push_back(piece);
      flips_.push_back(mesh_.edge_handle(mesh_.next_halfedge_handle(*it)));
    }
    relax();
  }

  void relax_all() {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      if (i % 1024 == 0) context_.checkpoint();
      for (auto it = mesh_.cfh_iter(faces_[i]); it.is_valid(); ++it) flips_.push_back(mesh_.edge_handle(*it));
      relax();
    }
  }

  /// Flips towards Delaunay. In space flips could go round in circles, hence the limit.
  void relax() {
    for (std::size_t left = 1000 + flips_.size(); !flips_.empty() && left > 0; --left) {
      const EdgeHandle e = flips_.back();
      flips_.pop_back();
      if (!wants_flip(e)) continue;
      flip_edge(view_, e);
      for (const HalfedgeHandle h : {mesh_.halfedge_handle(e, 0), mesh_.halfedge_handle(e, 1)}) {
        flips_.push_back(mesh_.edge_handle(mesh_.next_halfedge_handle(h)));
        flips_.push_back(mesh_.edge_handle(mesh_.prev_halfedge_handle(h)));
      }
    }
    flips_.clear();
  }

  bool wants_flip(EdgeHandle e) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(e, 0), o = mesh_.halfedge_handle(e, 1);
    const FaceHandle f = mesh_.face_handle(h), g = mesh_.face_handle(o);
    if (!f.is_valid() || !g.is_valid() || !inside_.count(f.idx()) || !inside_.count(g.idx())) return false;
    const VertexHandle va = mesh_.from_vertex_handle(h), vb = mesh_.to_vertex_handle(h),
                       vc = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)),
                       vd = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(o));
    const Vec3 &a = view_.point(va), &b = view_.point(vb), &c = view_.point(vc), &d = view_.point(vd);
    // The angles at c and d sum to more than two right ones: sin(c + d) < 0.
    const double cos_c = (a - c) | (b - c), cos_d = (a - d) | (b - d), sin_c = ((a - c) % (b - c)).norm(),
                 sin_d = ((a - d) % (b - d)).norm();
    if (!(sin_c * cos_d + cos_c * sin_d < -1e-9 * (a - b).sqrnorm() * ((c - a).norm() * (d - b).norm()))) return false;
    const double turn_now = normal_turn(triangle_normal(a, b, c), triangle_normal(b, a, d)),
                 turn_then = normal_turn(triangle_normal(c, a, d), triangle_normal(d, b, c));
    if (turn_then > std::max(turn_now, 0.1)) return false;
    if (!mesh_.is_flip_ok(e)) return false;
    if (!crossings_) return true;
    const int then = crossings_({vc, va, vd}) + crossings_({vd, vb, vc});
    return then == 0 || then <= crossings_({va, vb, vc}) + crossings_({vb, va, vd});
  }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  std::vector<FaceHandle>& faces_;
  double growth_;
  const std::function<int(const VertexTriple&)>& crossings_;
  const Context& context_;
  std::unordered_set<int> inside_;
  std::unordered_map<int, double> size_;  ///< edge length wanted, by vertex
  std::vector<EdgeHandle> flips_;
  std::vector<VertexHandle> added_;
};

}  // namespace

std::vector<VertexHandle> refine_faces(MeshView view, std::vector<FaceHandle>& faces, double growth,
                                       const std::function<int(const VertexTriple&)>& crossings,
                                       const Context& context) {
  return Refiner(view, faces, growth, crossings, context).run();
}

}  // namespace tri
