#include "meshops/operators/remove_redundant.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "meshops/editing/mesh_edit.hpp"
#include "meshops/search/local_spacing.hpp"

namespace tri {
namespace {

enum Mark : char { kept = 0, too_long, normal_off, outside, at_bow_tie };

constexpr int checkpoint_faces = 4096;

/// Centroids of the 16 congruent parts of a triangle: equal shares of its area.
std::vector<std::array<double, 3>> area_samples() {
  std::vector<std::array<double, 3>> samples;
  const double n = 4;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; i + j < 4; ++j) {
      const auto add = [&](double a, double b) { samples.push_back({a / n, b / n, 1 - (a + b) / n}); };
      add(i + 1.0 / 3, j + 1.0 / 3);
      if (i + j < 3) add(i + 2.0 / 3, j + 2.0 / 3);
    }
  return samples;
}

/// Decides which faces go; changes nothing in the mesh.
class Judgement {
 public:
  Judgement(MeshView view, const RemoveRedundantOptions& options, Context& context)
      : view_(view), mesh_(view.mesh), options_(options), context_(context), mark_(mesh_.n_faces(), kept) {}

  void run(Report& report) {
    mark_by_length();
    mark_by_normal();
    std::vector<int> boundary;
    for (int f = 0; f < faces(); ++f)
      if (is_kept(FaceHandle(f)) && at_boundary(FaceHandle(f))) boundary.push_back(f);
    peel(boundary);
    if (options_.keep_vertices) spare_vertices(report);
    if (options_.keep_vertices || view_.selection) {  // what would have to go as well may be outside the selection
      spare_bow_ties(report);
    } else {
      delete_bow_ties();
    }
    static constexpr const char* names[] = {"", "too long", "normal off", "outside the boundary", "at bow-ties"};
    for (const char m : mark_)
      if (m != kept) ++report.figures[names[static_cast<int>(m)]];
  }

  bool goes(FaceHandle f) const { return mark_[f.idx()] != kept; }

 private:
  int faces() const { return static_cast<int>(mesh_.n_faces()); }
  bool live(FaceHandle f) const { return f.is_valid() && !mesh_.status(f).deleted(); }
  bool is_kept(FaceHandle f) const { return live(f) && mark_[f.idx()] == kept; }

  bool may_go(FaceHandle f) const { return is_kept(f) && view_.may_replace(f); }

  std::array<VertexHandle, 3> corners(FaceHandle f) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(f), next = mesh_.next_halfedge_handle(h);
    return {mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h), mesh_.to_vertex_handle(next)};
  }
  Vec3 area_vector(FaceHandle f) const {
    const auto c = corners(f);
    return 0.5 * ((view_.point(c[1]) - view_.point(c[0])) % (view_.point(c[2]) - view_.point(c[0])));
  }
  /// Zero for a triangle without area.
  Vec3 normal(FaceHandle f) const {
    const Vec3 a = area_vector(f);
    const double length = a.norm();
    return length > 0 ? a / length : Vec3(0, 0, 0);
  }
  std::array<FaceHandle, 3> neighbors(FaceHandle f) const {
    std::array<FaceHandle, 3> result;
    HalfedgeHandle h = mesh_.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h))
      result[k] = mesh_.face_handle(mesh_.opposite_halfedge_handle(h));
    return result;
  }
  bool at_boundary(FaceHandle f) const {
    const auto n = neighbors(f);
    return !is_kept(n[0]) || !is_kept(n[1]) || !is_kept(n[2]);
  }
  double longest_edge(FaceHandle f) const {
    const auto c = corners(f);
    double longest = 0;
    for (int k = 0; k < 3; ++k) longest = std::max(longest, (view_.point(c[(k + 1) % 3]) - view_.point(c[k])).norm());
    return longest;
  }
  void pause(int f, double from, double to) const {
    if (f % checkpoint_faces != 0) return;
    context_.checkpoint();
    context_.progress("remove-redundant", from + (to - from) * f / std::max(1, faces()));
  }

  void mark_by_length() {
    const bool absolute = std::isfinite(options_.max_length);
    if (!absolute && !std::isfinite(options_.length_factor)) return;
    const std::vector<double> spacing = absolute ? std::vector<double>() : local_spacing(view_, &context_);
    for (int i = 0; i < faces(); ++i) {
      pause(i, 0, 0.3);
      const FaceHandle f(i);
      if (!may_go(f)) continue;
      const auto c = corners(f);
      for (int k = 0; k < 3; ++k) {
        const VertexHandle a = c[k], b = c[(k + 1) % 3];
        const double limit =
            absolute ? options_.max_length : options_.length_factor * std::max(spacing[a.idx()], spacing[b.idx()]);
        if ((view_.point(b) - view_.point(a)).norm() > limit) mark_[i] = too_long;
      }
    }
  }

  void mark_by_normal() {
    OpenMesh::VPropHandleT<Vec3> property;
    const bool at_vertices = !options_.reference && mesh_.get_property_handle(property, options_.normal_property);
    const bool referenced = options_.reference || at_vertices;
    const double limit = referenced ? options_.max_angle : options_.max_neighbor_angle;
    if (limit >= std::numbers::pi) return;
    const double least = std::cos(limit);
    std::vector<int> off;  // marked afterwards, so that the order of faces does not matter
    for (int i = 0; i < faces(); ++i) {
      pause(i, 0.3, 0.6);
      const FaceHandle f(i);
      if (!may_go(f)) continue;
      const Vec3 n = normal(f);
      if (n.sqrnorm() == 0) continue;
      const auto c = corners(f);
      double nearest = -2;  // largest cosine to a normal that says something
      if (options_.reference) {
        const Vec3 r = options_.reference->normal(c[0], c[1], c[2]);
        if (r.sqrnorm() > 0) nearest = n | r;
      } else if (at_vertices) {
        for (const VertexHandle v : c) {
          const Vec3& r = mesh_.property(property, v);
          if (r.sqrnorm() > 0) nearest = std::max(nearest, n | r);
        }
      } else {
        for (const FaceHandle g : neighbors(f))
          if (is_kept(g)) {
            const Vec3 r = normal(g);
            if (r.sqrnorm() > 0) nearest = std::max(nearest, n | r);
          }
      }
      if (nearest > -2 && nearest < least) off.push_back(i);
    }
    for (const int i : off) mark_[i] = normal_off;
  }

  bool stands_out(FaceHandle f) const {
    const auto c = corners(f);
    if (options_.reference) {
      if (options_.max_outside >= 1) return false;
      static const auto samples = area_samples();
      int out = 0;
      for (const auto& b : samples) out += !options_.reference->inside(c[0], c[1], c[2], b);
      return out > options_.max_outside * static_cast<double>(samples.size());
    }
    if (options_.max_boundary_angle >= std::numbers::pi) return false;
    HalfedgeHandle h = mesh_.halfedge_handle(f);
    for (int k = 0; k < 3; ++k, h = mesh_.next_halfedge_handle(h)) {
      if (is_kept(mesh_.face_handle(mesh_.opposite_halfedge_handle(h)))) continue;
      const Vec3& apex = view_.point(mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h)));
      const Vec3 a = view_.point(mesh_.from_vertex_handle(h)) - apex, b = view_.point(mesh_.to_vertex_handle(h)) - apex;
      if (std::atan2((a % b).norm(), a | b) > options_.max_boundary_angle) return true;
    }
    return false;
  }

  void peel(std::vector<int>& queue) {
    for (std::size_t at = 0; at < queue.size(); ++at) {
      if (at % checkpoint_faces == 0) context_.checkpoint();
      const FaceHandle f(queue[at]);
      if (!may_go(f) || !stands_out(f)) continue;
      mark_[f.idx()] = outside;
      for (const FaceHandle g : neighbors(f))
        if (is_kept(g)) queue.push_back(g.idx());
    }
  }

  /// The faces around a vertex, counter-clockwise, one list per fan that the mesh has there; `closed` if it is a single
  /// whole turn.
  void fans(VertexHandle v, std::vector<std::vector<FaceHandle>>& result, bool& closed) const {
    result.clear();
    closed = false;
    const HalfedgeHandle start = mesh_.halfedge_handle(v);
    if (!start.is_valid()) return;
    std::vector<HalfedgeHandle> around;
    HalfedgeHandle h = start;
    do {
      around.push_back(h);
      h = mesh_.opposite_halfedge_handle(mesh_.prev_halfedge_handle(h));
    } while (h != start);
    const auto gap =
        std::find_if(around.begin(), around.end(), [&](HalfedgeHandle o) { return !mesh_.face_handle(o).is_valid(); });
    closed = gap == around.end();
    if (!closed) std::rotate(around.begin(), gap + 1, around.end());
    bool open_new = true;
    for (const HalfedgeHandle o : around) {
      const FaceHandle f = mesh_.face_handle(o);
      if (!f.is_valid()) {
        open_new = true;
        continue;
      }
      if (open_new) result.emplace_back();
      open_new = false;
      result.back().push_back(f);
    }
  }

  /// Maximal runs [begin, end) of kept faces in one fan; of a closed fan, positions run on past the end of the list.
  std::vector<std::pair<int, int>> kept_runs(const std::vector<FaceHandle>& fan, bool closed) const {
    const int n = static_cast<int>(fan.size());
    std::vector<std::pair<int, int>> runs;
    for (int i = 0; i < n; ++i) {
      if (!is_kept(fan[i])) continue;
      if (i == 0 || !is_kept(fan[i - 1])) runs.push_back({i, i});
      runs.back().second = i + 1;
    }
    if (closed && runs.size() > 1 && runs.front().first == 0 && runs.back().second == n) {
      runs.back().second += runs.front().second;
      runs.erase(runs.begin());
    }
    return runs;
  }

  void delete_bow_ties() {
    std::vector<std::vector<FaceHandle>> around;
    std::vector<int> vertices = touched_vertices(), peeled;
    for (std::size_t at = 0; at < vertices.size(); ++at) {
      bool closed = false;
      fans(VertexHandle(vertices[at]), around, closed);
      peeled.clear();
      for (const auto& fan : around) {
        const auto runs = kept_runs(fan, closed);
        if (runs.size() < 2) continue;
        const int n = static_cast<int>(fan.size());
        std::size_t best = 0;
        const auto area = [&](const std::pair<int, int>& run) {
          double sum = 0;
          for (int i = run.first; i < run.second; ++i) sum += area_vector(fan[i % n]).norm();
          return sum;
        };
        const auto lowest = [&](const std::pair<int, int>& run) {
          int index = fan[run.first % n].idx();
          for (int i = run.first; i < run.second; ++i) index = std::min(index, fan[i % n].idx());
          return index;
        };
        for (std::size_t r = 1; r < runs.size(); ++r) {
          const int size = runs[r].second - runs[r].first, best_size = runs[best].second - runs[best].first;
          if (size < best_size) continue;
          const double mine = area(runs[r]), his = area(runs[best]);
          if (size > best_size || mine > his || (mine == his && lowest(runs[r]) < lowest(runs[best]))) best = r;
        }
        for (std::size_t r = 0; r < runs.size(); ++r)
          if (r != best)
            for (int i = runs[r].first; i < runs[r].second; ++i) {
              mark_[fan[i % n].idx()] = at_bow_tie;
              peeled.push_back(fan[i % n].idx());
            }
      }
      // What lost a neighbour is at the boundary now, and its corners may have become bow-ties.
      std::vector<int> gone = peeled, queue;
      for (const int f : peeled)
        for (const FaceHandle g : neighbors(FaceHandle(f)))
          if (is_kept(g)) queue.push_back(g.idx());
      peel(queue);
      for (const int f : queue)
        if (!is_kept(FaceHandle(f))) gone.push_back(f);
      for (const int f : gone)
        for (const VertexHandle v : corners(FaceHandle(f))) vertices.push_back(v.idx());
    }
  }

  void spare_vertices(Report& report) {
    for (const int v : touched_vertices()) {
      FaceHandle best;
      double shortest = std::numeric_limits<double>::infinity();
      bool has_face = false;
      for (auto it = mesh_.cvf_iter(VertexHandle(v)); it.is_valid(); ++it) {
        has_face = has_face || is_kept(*it);
        const double longest = longest_edge(*it);
        if (longest < shortest || (longest == shortest && (*it).idx() < best.idx())) shortest = longest, best = *it;
      }
      if (has_face || !best.is_valid()) continue;
      mark_[best.idx()] = kept;
      ++report.skipped["spared for a vertex"];
    }
  }

  void spare_bow_ties(Report& report) {
    std::vector<std::vector<FaceHandle>> around;
    std::vector<int> vertices = touched_vertices();
    for (std::size_t at = 0; at < vertices.size(); ++at) {
      bool closed = false;
      fans(VertexHandle(vertices[at]), around, closed);
      for (const auto& fan : around) {
        const int n = static_cast<int>(fan.size());
        auto runs = kept_runs(fan, closed);
        if (runs.size() < 2) continue;
        struct Gap {
          int first, size;
        };
        std::vector<Gap> gaps;
        for (std::size_t r = 0; r + 1 < runs.size(); ++r)
          gaps.push_back({runs[r].second, runs[r + 1].first - runs[r].second});
        if (closed) gaps.push_back({runs.back().second, runs.front().first + n - runs.back().second});
        // Of a closed fan one gap, the widest, may stay open.
        std::stable_sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.size < b.size; });
        for (std::size_t g = 0; g + 1 < runs.size(); ++g)
          for (int i = gaps[g].first; i < gaps[g].first + gaps[g].size; ++i) {
            const FaceHandle f = fan[i % n];
            mark_[f.idx()] = kept;
            ++report.skipped["spared for a bow-tie"];
            for (const VertexHandle v : corners(f)) vertices.push_back(v.idx());
          }
      }
    }
  }

  /// Corners of the faces that go, ascending.
  std::vector<int> touched_vertices() const {
    std::vector<int> vertices;
    for (int f = 0; f < faces(); ++f)
      if (mark_[f] != kept)
        for (const VertexHandle v : corners(FaceHandle(f))) vertices.push_back(v.idx());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  MeshView view_;
  const OpenMesh::TriConnectivity& mesh_;
  const RemoveRedundantOptions& options_;
  Context& context_;
  std::vector<char> mark_;
};

}  // namespace

const OptionSchema& RemoveRedundantOptions::schema() {
  using O = RemoveRedundantOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("length-factor", &O::length_factor,
                  {.min = 1, .infinite = true, .help = "longest edge allowed, times the local spacing"})
          .number("max-length", &O::max_length,
                  {.unit = "mm",
                   .min = 0,
                   .min_open = true,
                   .infinite = true,
                   .help = "longest edge allowed, in place of length-factor"})
          .angle("max-angle", &O::max_angle,
                 {.min = 0, .max = 180, .help = "largest angle to the reference normal; 180 is off"})
          .angle("max-neighbor-angle", &O::max_neighbor_angle,
                 {.min = 0,
                  .max = 180,
                  .help = "largest angle to the nearest neighbour without reference normals; 180 is off"})
          .number("max-outside", &O::max_outside,
                  {.min = 0,
                   .max = 1,
                   .help = "share of a boundary triangle that may be outside the trimmed region; 1 is off"})
          .angle(
              "max-boundary-angle", &O::max_boundary_angle,
              {.min = 0, .max = 180, .help = "largest angle opposite a boundary edge without a reference; 180 is off"})
          .boolean("keep-vertices", &O::keep_vertices, {.help = "no vertex loses its last triangle"})
          .text("normal-property", &O::normal_property, {.help = "vertex property with reference normals"});
  return schema;
}

Report remove_redundant(MeshView view, const RemoveRedundantOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  Report report;
  report.operation = "remove-redundant";
  Judgement judgement(view, options, context);
  judgement.run(report);
  context.checkpoint();

  const auto& mesh = view.mesh;
  std::vector<VertexHandle> corners;
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i) {
    const FaceHandle f(i);
    if (!judgement.goes(f)) continue;
    for (auto it = mesh.cfv_iter(f); it.is_valid(); ++it) corners.push_back(*it);
    delete_face(view, f);
    ++report.faces_removed;
    report.touched_faces.push_back(static_cast<std::uint32_t>(i));
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  for (const VertexHandle v : corners) {
    report.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
    if (options.keep_vertices || !mesh.is_isolated(v) || !view.may_move(v)) continue;
    delete_vertex(view, v);
    ++report.vertices_removed;
  }
  context.progress("remove-redundant", 1);
  return report;
}

}  // namespace tri
