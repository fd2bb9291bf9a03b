#include "meshops/operators/subdivide.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "meshops/crossings/crossing_guard.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/editing/vertex_rows.hpp"
#include "meshops/error.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/limits.hpp"
#include "meshops/shape/features.hpp"
#include "meshops/shape/subdivision_stencils.hpp"

namespace tri {
namespace {

constexpr std::size_t subdivide_block = 4096;
constexpr double most_faces = 5e8;  ///< then half-edges still have an index

template <class Handle>
std::size_t index_of(Handle h) {
  return static_cast<std::size_t>(h.idx());
}

class Subdivider {
 public:
  Subdivider(MeshView view, const SubdivideOptions& options, Context& context)
      : view_(view), mesh_(view.mesh), options_(options), context_(context) {}

  Report run() {
    context_.checkpoint();
    check_size();
    if (options_.scheme != SubdivisionScheme::midpoint)
      features_ =
          find_features(view_, {.angle = options_.feature_angle, .corner_angle = options_.corner_angle}, context_);
    old_vertices_ = mesh_.n_vertices();
    const std::size_t old_faces = mesh_.n_faces();
    face_touched_.assign(old_faces, 0);
    vertex_touched_.assign(old_vertices_, 0);
    // Four times as much from level to level.
    double done = 0, all = 0;
    for (int level = 0; level < options_.levels; ++level) all += std::pow(4.0, level);
    for (int level = 0; level < options_.levels; ++level) {
      const double share = std::pow(4.0, level) / all;
      progress_begin_ = done;
      progress_share_ = share;
      refine();
      done += share;
    }
    context_.progress("subdivide", 1);
    if (kept_back_ > 0) {
      report_.skipped["vertices where triangles would fold or cross"] = kept_back_;
      report_.notes.push_back(
          fmt::format("{} vertices stay on the triangles of the level before, since pieces would fold over or cross "
                      "others; the first at ({:.6g}, {:.6g}, {:.6g})",
                      kept_back_, first_kept_[0], first_kept_[1], first_kept_[2]));
    }
    report_.vertices_added = mesh_.n_vertices() - old_vertices_;
    report_.faces_added = mesh_.n_faces() - old_faces;
    list(vertex_touched_, mesh_.n_vertices(), report_.touched_vertices);
    list(face_touched_, mesh_.n_faces(), report_.touched_faces);
    report_.vertices_moved = report_.touched_vertices.size() - report_.vertices_added;
    return std::move(report_);
  }

 private:
  void check_size() const {
    const double faces = static_cast<double>(mesh_.n_faces()) * std::pow(4.0, options_.levels);
    if (faces > most_faces)
      throw InvalidInput(
          fmt::format("option levels = {} is not allowed; this mesh would get {:.3g} faces, and {:.3g} are allowed",
                      options_.levels, faces, most_faces));
  }

  void refine() {
    choose_edges();
    edge_points_.resize(splits_.size());
    for_each_block(context_, "", splits_.size(), subdivide_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (splits_[i]) edge_points_[i] = edge_point(EdgeHandle(static_cast<int>(i)));
    });
    vertex_points_.resize(mesh_.n_vertices());
    for_each_block(context_, "", vertex_points_.size(), subdivide_block,
                   [&](std::size_t, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i)
                       vertex_points_[i] = vertex_point(VertexHandle(static_cast<int>(i)));
                   });
    split_edges();
    turn_inner_edges();
    place_points();
  }

  void choose_edges() {
    splits_.assign(mesh_.n_edges(), 0);
    std::vector<std::size_t> refused((splits_.size() + subdivide_block - 1) / subdivide_block, 0);
    for_each_block(context_, "", splits_.size(), subdivide_block,
                   [&](std::size_t block, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i) {
                       const EdgeHandle e(static_cast<int>(i));
                       if (mesh_.status(e).deleted() || !view_.may_change(e)) continue;
                       const bool possible = mesh_.is_boundary(e) || far_corner(e, 0) != far_corner(e, 1);
                       splits_[i] = possible;
                       refused[block] += !possible;
                     }
                   });
    if (const auto count = std::accumulate(refused.begin(), refused.end(), std::uint64_t{0}))
      report_.skipped["edges of triangles back to back"] = count;
  }

  VertexHandle far_corner(EdgeHandle e, unsigned side) const {
    return mesh_.to_vertex_handle(mesh_.next_halfedge_handle(mesh_.halfedge_handle(e, side)));
  }

  Vec3 edge_point(EdgeHandle e) const {
    const Vec3 middle = (view_.point(mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 0))) +
                         view_.point(mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 1)))) /
                        2;
    if (options_.scheme == SubdivisionScheme::midpoint) return middle;
    const Vec3 result = options_.scheme == SubdivisionScheme::loop ? loop_edge_point(view_, features_, e)
                                                                   : butterfly_edge_point(view_, features_, e);
    return is_finite(result) ? result : middle;
  }

  Vec3 vertex_point(VertexHandle v) const {
    const Vec3& old = view_.point(v);
    if (options_.scheme != SubdivisionScheme::loop || mesh_.status(v).deleted() || mesh_.is_isolated(v) ||
        !view_.may_move(v))
      return old;
    bool all_split = true;
    for_each_outgoing(mesh_, v,
                      [&](HalfedgeHandle h) { all_split = all_split && splits_[index_of(mesh_.edge_handle(h))]; });
    if (!all_split) return old;
    const Vec3 result = loop_vertex_point(view_, features_, v);
    return is_finite(result) ? result : old;
  }

  /// Every chosen edge, in its middle, so that the surface stays what it is.
  void split_edges() {
    const std::size_t chosen = static_cast<std::size_t>(std::count(splits_.begin(), splits_.end(), 1));
    mesh_.reserve(mesh_.n_vertices() + chosen, mesh_.n_edges() + 3 * chosen, mesh_.n_faces() + 2 * chosen);
    first_new_vertex_ = mesh_.n_vertices();
    first_new_edge_ = mesh_.n_edges();
    inner_.clear();
    new_points_.clear();
    const bool classes = options_.scheme != SubdivisionScheme::midpoint;
    for (std::size_t i = 0; i < splits_.size(); ++i) {
      if (i % 1024 == 0) {
        context_.checkpoint();
        context_.progress("subdivide", progress_begin_ + progress_share_ * 0.7 * static_cast<double>(i) /
                                                             static_cast<double>(splits_.size()));
      }
      if (!splits_[i]) continue;
      const EdgeHandle e(static_cast<int>(i));
      const std::size_t half = mesh_.n_edges();
      const VertexHandle a = mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 1)),
                         b = mesh_.to_vertex_handle(mesh_.halfedge_handle(e, 0));
      for (const unsigned side : {0u, 1u}) touch(mesh_.face_handle(mesh_.halfedge_handle(e, side)));
      split_edge(view_, e, (view_.point(a) + view_.point(b)) / 2, 0.5);
      new_points_.push_back(edge_points_[i]);
      inner_.resize(mesh_.n_edges() - first_new_edge_, 1);
      inner_[half - first_new_edge_] = 0;
      if (!classes) continue;
      const EdgeClass c = features_.edges[i];
      features_.edges.resize(mesh_.n_edges(), EdgeClass::smooth);
      features_.edges[half] = c;
      features_.vertices.push_back(c == EdgeClass::crease     ? VertexClass::crease
                                   : c == EdgeClass::boundary ? VertexClass::boundary
                                                              : VertexClass::smooth);
    }
  }

  void touch(FaceHandle f) {
    if (f.is_valid() && index_of(f) < face_touched_.size()) face_touched_[index_of(f)] = 1;
  }

  /// A triangle whose three edges were split has its four pieces when the inner edge between a new and an old vertex
  /// joins the two other new ones.
  void turn_inner_edges() {
    const auto is_new = [&](VertexHandle v) { return index_of(v) >= first_new_vertex_; };
    for (std::size_t i = 0; i < inner_.size(); ++i) {
      if (i % 1024 == 0) {
        context_.checkpoint();
        context_.progress("subdivide",
                          progress_begin_ + progress_share_ * (0.7 + 0.2 * static_cast<double>(i) /
                                                                         static_cast<double>(inner_.size())));
      }
      if (!inner_[i]) continue;
      const EdgeHandle e(static_cast<int>(first_new_edge_ + i));
      const HalfedgeHandle left = mesh_.halfedge_handle(e, 0), right = mesh_.halfedge_handle(e, 1);
      if (is_new(mesh_.to_vertex_handle(left)) == is_new(mesh_.to_vertex_handle(right))) continue;
      if (!is_new(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(left))) ||
          !is_new(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(right))))
        continue;
      // Only triangles back to back could have the edge already.
      if (mesh_.is_flip_ok(e)) flip_edge(view_, e);
    }
  }

  void place_points() {
    context_.checkpoint();
    vertex_points_.insert(vertex_points_.end(), new_points_.begin(), new_points_.end());
    if (options_.scheme != SubdivisionScheme::midpoint && options_.guard != SubdivisionGuard::none) keep_back();
    for (std::size_t i = 0; i < vertex_points_.size(); ++i) {
      const VertexHandle v(static_cast<int>(i));
      if (!is_finite(vertex_points_[i]) || view_.point(v) == vertex_points_[i]) continue;
      set_point(view_, v, vertex_points_[i]);
      if (i < old_vertices_) vertex_touched_[i] = 1;
    }
  }

  /// The pieces lie on the triangles of the level before now. Vertices of pieces that would be turned over, or cross
  /// others where these are looked for, keep their places, until there are none.
  void keep_back() {
    std::vector<char> kept(vertex_points_.size(), 0);
    const auto keep = [&](const Triangle& t) {
      bool any = false;
      for (const std::uint32_t v : t) {
        const Vec3& flat = view_.point(VertexHandle(static_cast<int>(v)));
        if (!is_finite(vertex_points_[v]) || vertex_points_[v] == flat) continue;
        vertex_points_[v] = flat;
        kept[v] = 1;
        any = true;
      }
      return any;
    };
    do keep_back_folds(keep);
    while (options_.guard == SubdivisionGuard::crossings && keep_back_crossings(keep));
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (!kept[i]) continue;
      if (kept_back_++ == 0) first_kept_ = vertex_points_[i];
    }
  }

  template <class Keep>
  void keep_back_folds(const Keep& keep) {
    const std::size_t n = mesh_.n_faces();
    std::vector<std::vector<Triangle>> turned((n + subdivide_block - 1) / subdivide_block);  // few, if any
    for (bool any = true; any;) {
      for_each_block(context_, "", n, subdivide_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
        turned[block].clear();
        for (std::size_t i = begin; i < end; ++i) {
          const FaceHandle f(static_cast<int>(i));
          if (mesh_.status(f).deleted()) continue;
          const Triangle t = corners_of(f);
          std::array<Vec3, 3> flat;
          for (std::size_t k = 0; k < 3; ++k) flat[k] = view_.point(VertexHandle(static_cast<int>(t[k])));
          const Vec3 &a = vertex_points_[t[0]], &b = vertex_points_[t[1]], &c = vertex_points_[t[2]];
          if ((((flat[1] - flat[0]) % (flat[2] - flat[0])) | ((b - a) % (c - a))) < 0) turned[block].push_back(t);
        }
      });
      any = false;
      for (const auto& of_block : turned)
        for (const Triangle& t : of_block) any = keep(t) || any;
    }
  }

  /// @return whether there were any to keep
  template <class Keep>
  bool keep_back_crossings(const Keep& keep) const {
    std::vector<Triangle> finite;
    finite.reserve(mesh_.n_faces());
    for (std::size_t i = 0; i < mesh_.n_faces(); ++i) {
      if (i % 65536 == 0) context_.checkpoint();
      const FaceHandle f(static_cast<int>(i));
      if (mesh_.status(f).deleted()) continue;
      const Triangle t = corners_of(f);
      if (std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return is_finite(vertex_points_[v]); }))
        finite.push_back(t);
    }
    bool any = false;
    for (const auto& pair : crossing_pairs(vertex_points_, finite, context_))
      for (const std::uint32_t t : pair) any = keep(finite[t]) || any;
    return any;
  }

  Triangle corners_of(FaceHandle f) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(f), next = mesh_.next_halfedge_handle(h);
    return {static_cast<std::uint32_t>(mesh_.from_vertex_handle(h).idx()),
            static_cast<std::uint32_t>(mesh_.to_vertex_handle(h).idx()),
            static_cast<std::uint32_t>(mesh_.to_vertex_handle(next).idx())};
  }

  /// Those that were there and are marked, and all that were not.
  static void list(const std::vector<char>& marked, std::size_t count, std::vector<std::uint32_t>& result) {
    for (std::size_t i = 0; i < count; ++i)
      if (i >= marked.size() || marked[i]) result.push_back(static_cast<std::uint32_t>(i));
  }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  const SubdivideOptions& options_;
  Context& context_;
  Report report_;
  Features features_;  ///< of the level; empty for `midpoint`
  std::size_t old_vertices_ = 0;
  std::uint64_t kept_back_ = 0;  ///< vertices, of each level anew
  Vec3 first_kept_{0, 0, 0};
  double progress_begin_ = 0, progress_share_ = 0;
  std::vector<char> face_touched_, vertex_touched_;  ///< of those that were there before the first level
  // Of the level:
  std::vector<char> splits_;         ///< per edge
  std::vector<Vec3> edge_points_;    ///< where the new vertex of an edge goes
  std::vector<Vec3> vertex_points_;  ///< where a vertex goes
  std::size_t first_new_vertex_ = 0, first_new_edge_ = 0;
  std::vector<Vec3> new_points_;  ///< where the new vertices go
  std::vector<char> inner_;       ///< per new edge: lies inside a triangle of the level before
};

}  // namespace

const OptionSchema& SubdivideOptions::schema() {
  using O = SubdivideOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("scheme", &O::scheme,
                  {{"loop", SubdivisionScheme::loop},
                   {"butterfly", SubdivisionScheme::butterfly},
                   {"midpoint", SubdivisionScheme::midpoint}},
                  {.help = "loop smooths, butterfly keeps the vertices, midpoint the surface"})
          .choice("guard", &O::guard,
                  {{"folds", SubdivisionGuard::folds},
                   {"crossings", SubdivisionGuard::crossings},
                   {"none", SubdivisionGuard::none}},
                  {.help = "vertices stay back where pieces would be turned over; crossings: or cross others, slower"})
          .integer("levels", &O::levels, {.min = 1, .max = 12, .help = "how often; each makes four triangles of one"})
          .angle("feature-angle", &O::feature_angle,
                 {.min = 0, .max = 180, .help = "edges with a larger angle between normals stay sharp; 180: none"})
          .angle("corner-angle", &O::corner_angle,
                 {.min = 0, .max = 180, .help = "where a crease or boundary turns by more is a corner; 180: none"});
  return schema;
}

Report subdivide(MeshView mesh, const SubdivideOptions& options, Context& context) {
  validate(options);
  return Subdivider(mesh, options, context).run();
}

}  // namespace tri
