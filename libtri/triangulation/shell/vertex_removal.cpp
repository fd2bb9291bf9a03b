#include "libtri/triangulation/shell/vertex_removal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>

#include "libtri/triangulation/shell/triangle_cost.hpp"
#include "meshops/holes/polygon_triangulation.hpp"
#include "meshops/limits.hpp"

namespace tri {
namespace {

constexpr std::size_t largest_ring = 48;
/// Larger stars wait until removals around them have made them smaller; at last they lose ears first.
constexpr std::size_t largest_fan = 4096;
struct Plan {
  double cost = infinity;  ///< how much the star's cost rises
  std::vector<Triangle> patch;
};

class Remover {
 public:
  Remover(EditMesh& mesh, Context& context)
      : mesh_(mesh), context_(context), cost_(mesh), position_(mesh.vertices.size(), -1) {}

  VertexRemoval run() {
    std::vector<std::uint32_t> version(mesh_.vertices.size(), 0);
    struct Entry {
      double cost;
      std::uint32_t vertex, version;
      bool operator<(const Entry& o) const { return cost != o.cost ? cost > o.cost : vertex > o.vertex; }
    };
    std::priority_queue<Entry> queue;
    std::vector<std::uint32_t> stuck;
    std::size_t total = 0;
    for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (mesh_.vertices[v].point >= 0 || mesh_.vertex_triangle[v] < 0) continue;
      ++total;
      if (total % 128 == 0) context_.checkpoint();
      queue.push({plan(v, largest_ring).cost, v, 0});
    }
    VertexRemoval result;
    EditMesh::Star star;
    std::size_t ring_limit = largest_ring;
    std::size_t removed_before = 0;
    while (true) {
      while (!queue.empty()) {
        const Entry top = queue.top();
        queue.pop();
        if (mesh_.vertex_triangle[top.vertex] < 0 || top.version != version[top.vertex]) continue;
        const Plan p = plan(top.vertex, ring_limit);
        if (p.cost == infinity) {
          stuck.push_back(top.vertex);
          continue;
        }
        mesh_.star(top.vertex, star, largest_fan);
        mesh_.replace_star(top.vertex, star, p.patch);
        ++result.removed;
        if (result.removed % 128 == 0) {
          context_.checkpoint();
          context_.progress("remove model vertices", static_cast<double>(result.removed) / static_cast<double>(total));
        }
        for (std::uint32_t w : star.ring) {
          if (mesh_.vertices[w].point >= 0) continue;
          queue.push({plan(w, ring_limit).cost, w, ++version[w]});
        }
      }
      if (stuck.empty()) break;
      if (result.removed == removed_before) {
        if (ring_limit == largest_fan) break;
        ring_limit = largest_fan;
      }
      removed_before = result.removed;
      for (std::uint32_t v : stuck)
        if (mesh_.vertex_triangle[v] >= 0) queue.push({plan(v, ring_limit).cost, v, ++version[v]});
      stuck.clear();
    }
    result.kept = total - result.removed;
    if (total > 0) context_.progress("remove model vertices", 1);
    return result;
  }

 private:
  Plan plan(std::uint32_t v, std::size_t ring_limit) {
    Plan result;
    if (!mesh_.star(v, star_, ring_limit)) return result;
    const std::size_t n = star_.ring.size();
    if (star_.closed ? n < 3 : n < 2) return result;
    find_outer_edges(v);
    double before = 0;
    for (std::int32_t t : star_.fan) before += cost_(mesh_.triangles[t]);
    left_.resize(n);
    std::iota(left_.begin(), left_.end(), 0);
    double after = cut_ears(v, result.patch);
    if (after < infinity) after += star_.closed ? fill_ring(result.patch) : fill_open_fan(v, result.patch);
    if (after < infinity) result.cost = after - before;
    return result;
  }

  /// For each pair of ring vertices whether an edge outside the star joins them.
  void find_outer_edges(std::uint32_t v) {
    const std::size_t n = star_.ring.size();
    outer_.assign(n * n, false);
    for (std::size_t i = 0; i < n; ++i) position_[star_.ring[i]] = static_cast<std::int32_t>(i);
    for (std::size_t i = 0; i < n; ++i)
      mesh_.for_neighbors(star_.ring[i], [&](std::uint32_t w) {
        if (w != v && position_[w] >= 0) outer_[i * n + static_cast<std::size_t>(position_[w])] = true;
      });
    for (const std::uint32_t w : star_.ring) position_[w] = -1;
  }
  /// Whether the vertices at positions `i` and `j` of what is left of the ring share an edge outside the star.
  bool taken(int i, int j) const {
    return outer_[static_cast<std::size_t>(left_[i]) * star_.ring.size() + static_cast<std::size_t>(left_[j])];
  }
  std::uint32_t ring(int i) const { return star_.ring[left_[i]]; }

  double fill_ring(std::vector<Triangle>& patch) {
    ring_triangles_.clear();
    const int n = static_cast<int>(left_.size());
    const auto best = triangulate_polygon<double>(
        n, [&](int i, int j) { return !taken(i, j); },
        [&](int i, int k, int j, int, int) -> std::optional<double> { return cost_(ring(i), ring(k), ring(j)); },
        ring_triangles_);
    if (!best) return infinity;
    for (const RingTriangle& t : ring_triangles_) patch.push_back({ring(t[0]), ring(t[1]), ring(t[2])});
    // A ring of three whose triangle is there already would close a pillow.
    if (n == 3 && is_triangle(ring(0), ring(2), ring(1))) return infinity;
    return *best;
  }

  bool is_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    EditMesh::Star around;
    mesh_.star(a, around, std::numeric_limits<std::size_t>::max());
    for (std::int32_t t : around.fan) {
      const int k = mesh_.corner(t, a);
      if (mesh_.triangles[t][(k + 1) % 3] == b && mesh_.triangles[t][(k + 2) % 3] == c) return true;
    }
    return false;
  }

  /// Rings that are too long for the dynamic programme lose ears first, in the order of the power of `v` over their
  /// circumcircles, which in the plane yields the Delaunay triangulation of the ring [Heller 1990; Devillers 1999].
  /// @return the cost of the ears
  double cut_ears(std::uint32_t v, std::vector<Triangle>& patch) {
    if (left_.size() <= largest_ring) return 0;
    Vec3 normal(0, 0, 0);
    for (std::int32_t t : star_.fan) normal += area_vector(mesh_.triangles[t]);
    const double length = normal.norm();
    if (!(length > 0)) return infinity;
    normal /= length;
    const Vec3 x = (std::abs(normal[0]) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)) % normal, y = normal % x;
    std::vector<Vec2> q;
    for (std::uint32_t w : star_.ring) {
      const Vec3 d = mesh_.vertices[w].p - mesh_.vertices[v].p;
      q.emplace_back(d | x, d | y);
    }
    const auto power = [&](int i) {  // of the origin over the ear's circumcircle; infinite for what is no ear
      const int n = static_cast<int>(left_.size());
      if (!star_.closed && (i == 0 || i == n - 1)) return infinity;
      const int before = (i + n - 1) % n, after = (i + 1) % n;
      const Vec2 &a = q[left_[before]], &b = q[left_[i]], &c = q[left_[after]];
      const double turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      if (!(turn > 0) || taken(before, after)) return infinity;
      const double aa = a.sqrnorm(), bb = b.sqrnorm(), cc = c.sqrnorm();
      const double circle =
          aa * (b[0] * c[1] - b[1] * c[0]) - bb * (a[0] * c[1] - a[1] * c[0]) + cc * (a[0] * b[1] - a[1] * b[0]);
      return circle / turn;
    };
    std::vector<double> powers;
    for (int i = 0; i < static_cast<int>(left_.size()); ++i) powers.push_back(power(i));
    double sum = 0;
    while (left_.size() > largest_ring) {
      const int n = static_cast<int>(left_.size());
      const int i = static_cast<int>(std::min_element(powers.begin(), powers.end()) - powers.begin());
      if (powers[i] == infinity) return infinity;
      patch.push_back({ring((i + n - 1) % n), ring(i), ring((i + 1) % n)});
      sum += cost_(patch.back());
      left_.erase(left_.begin() + i);
      powers.erase(powers.begin() + i);
      for (int k : {i % (n - 1), (i + n - 2) % (n - 1)}) powers[k] = power(k);
    }
    return sum;
  }

  /// Covers the fan of a boundary vertex anew: a boundary path from the first to the last ring vertex is chosen, and
  /// every stretch of the ring that a chord of the path cuts off is triangulated.
  double fill_open_fan(std::uint32_t v, std::vector<Triangle>& patch) {
    const int n = static_cast<int>(left_.size());
    // cost[i][j]: the stretch i..j triangulated with chord (i, j) closing it; apex to trace it.
    stretch_.assign(static_cast<std::size_t>(n * n), infinity);
    area_.assign(static_cast<std::size_t>(n * n), 0);
    apex_.assign(static_cast<std::size_t>(n * n), -1);
    const auto at = [n](int i, int j) { return static_cast<std::size_t>(i * n + j); };
    for (int i = 0; i + 1 < n; ++i) stretch_[at(i, i + 1)] = 0;
    for (int span = 2; span < n; ++span)
      for (int i = 0; i + span < n; ++i) {
        const int j = i + span;
        if (taken(i, j)) continue;
        for (int k = i + 1; k < j; ++k) {
          const double parts = stretch_[at(i, k)] + stretch_[at(k, j)];
          if (parts >= stretch_[at(i, j)]) continue;
          const double sum = parts + cost_(ring(i), ring(k), ring(j));
          if (sum < stretch_[at(i, j)]) {
            stretch_[at(i, j)] = sum;
            apex_[at(i, j)] = k;
            area_[at(i, j)] = area_[at(i, k)] + area_[at(k, j)] + area(ring(i), ring(k), ring(j));
          }
        }
      }
    std::vector<double> fan_area(static_cast<std::size_t>(n), 0);
    for (int i = 0; i + 1 < n; ++i) fan_area[i + 1] = fan_area[i] + area(v, ring(i), ring(i + 1));
    std::vector<double> best(static_cast<std::size_t>(n), infinity);
    std::vector<int> previous(static_cast<std::size_t>(n), -1);
    best[0] = 0;
    for (int j = 1; j < n; ++j) {
      if (j + 1 < n && mesh_.on_boundary(ring(j))) continue;  // the boundary would touch itself there
      for (int i = 0; i < j; ++i) {
        if (best[i] == infinity || stretch_[at(i, j)] == infinity) continue;
        if (j == i + 1 && !covered_outside(i, v)) continue;
        const double missing = (fan_area[j] - fan_area[i]) - area_[at(i, j)];
        const double sum = best[i] + stretch_[at(i, j)] + (missing > 0 ? 3 * missing : -8 * missing);
        if (sum < best[j]) best[j] = sum, previous[j] = i;
      }
    }
    if (best[n - 1] == infinity) return infinity;
    for (int j = n - 1; j > 0; j = previous[j]) trace(previous[j], j, patch);
    return best[n - 1];
  }

  void trace(int i, int j, std::vector<Triangle>& patch) const {
    if (j == i + 1) return;
    const int n = static_cast<int>(left_.size());
    const int k = apex_[static_cast<std::size_t>(i * n + j)];
    patch.push_back({ring(i), ring(k), ring(j)});
    trace(i, k, patch);
    trace(k, j, patch);
  }

  /// Whether a triangle remains beyond the stretch from position `i` to the next if the patch leaves it out.
  bool covered_outside(int i, std::uint32_t v) const {
    if (left_[i + 1] > left_[i] + 1) return true;  // an ear
    const std::int32_t t = star_.fan[left_[i]];
    return mesh_.neighbors[t][mesh_.corner(t, v)] >= 0;
  }

  Vec3 area_vector(const Triangle& t) const {
    const Vec3& p = mesh_.vertices[t[0]].p;
    return 0.5 * ((mesh_.vertices[t[1]].p - p) % (mesh_.vertices[t[2]].p - p));
  }
  double area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const { return area_vector({a, b, c}).norm(); }

  EditMesh& mesh_;
  Context& context_;
  TriangleCost cost_;
  EditMesh::Star star_;
  std::vector<bool> outer_;
  std::vector<int> left_;               // positions in the star's ring that no ear has cut off
  std::vector<std::int32_t> position_;  // in the star's ring; -1 for other vertices
  std::vector<RingTriangle> ring_triangles_;
  std::vector<double> stretch_, area_;
  std::vector<int> apex_;
};

}  // namespace

VertexRemoval remove_model_vertices(EditMesh& mesh, Context& context) {
  return Remover(mesh, context).run();
}

}  // namespace tri
