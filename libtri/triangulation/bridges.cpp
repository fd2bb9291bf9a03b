#include "libtri/triangulation/bridges.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "libtri/quiet_context.hpp"
#include "libtri/surfaces/crossing_search.hpp"
#include "libtri/triangulation/shell/edit_mesh.hpp"
#include "libtri/triangulation/shell/triangle_cost.hpp"
#include "libtri/triangulation/shell/triangle_geometry.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/holes/polygon_triangulation.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/disjoint_sets.hpp"

namespace tri {
namespace {

constexpr double across = 0.5;      ///< cosine of the angle to the model's normal below which a triangle bridges
constexpr double suspicious = 0.7;  ///< triangles that agree better with the normals at their corners are not looked at
constexpr double bridge_weight = 10, fold_weight = 10;  ///< times the area that bridges or is folded over
constexpr double fold_cosine = -0.8660254037844386;     ///< 150 degrees
/// Ring vertices of a region. Large regions take as long as all before and are tried only where more than `much` is
/// left.
constexpr std::array<int, 3> small_rings{6, 10, 14};
constexpr std::array<int, 1> large_rings{28};
constexpr double much = 0.005;    ///< of the area
constexpr int most_rounds = 6;    ///< over what still bridges
constexpr int most_attempts = 4;  ///< at a region whose best triangulations cross others
constexpr int most_crossing_rounds = 3;
constexpr double most_rise = 1.1;              ///< of a region's sum, for fewer crossings
constexpr std::size_t most_in_vain = 100;      ///< regions of crossings in turn that nothing helped
constexpr int zone_steps = 14;                 ///< triangles around a bridging one that may change
constexpr std::size_t most_changes = 400;      ///< before the search for crossings is sorted anew; more in a large zone
constexpr std::size_t triangles_block = 8192;  ///< triangles

using Normal = std::array<float, 3>;

double dot(const Normal& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Whether a triangle over points with these normals of the model may bridge. @param n  its normal, of length
/// `twice_area`
bool disagrees(const Vec3& n, double twice_area, const Normal& a, const Normal& b, const Normal& c) {
  const double least = suspicious * twice_area;
  return dot(a, n) < least || dot(b, n) < least || dot(c, n) < least;
}

struct TripleHash {
  std::size_t operator()(const Triangle& t) const {
    std::uint64_t h = 0;
    for (std::uint32_t v : t) h = (h ^ v) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    return h;
  }
};

/// Tells which triangles over the points stand across the model; remembers what was asked.
class BridgeTest {
 public:
  BridgeTest(std::span<const Foot> feet, const Registration& registration, double tolerance, const Context& context)
      : feet_(feet), registration_(registration), tolerance_(tolerance), quiet_(context, context.threads) {}

  /// Finds out about all of `triangles`, which may bridge, at once.
  void ask(std::span<const Triangle> triangles) {
    wanted_.clear();
    turned_.clear();
    middles_.clear();
    Pace pace(quiet_);
    for (const Triangle& t : triangles) {
      pace();
      const Foot &a = feet_[t[0]], &b = feet_[t[1]], &c = feet_[t[2]];
      const Triangle key = sorted(t);
      if (!known_.emplace(key, false).second) continue;
      wanted_.push_back(key);
      turned_.push_back(is_odd(t));
      middles_.push_back((a.point + b.point + c.point) / 3.0);
    }
    if (wanted_.empty()) return;
    const std::vector<Foot> nearest = registration_.register_points(middles_, quiet_);
    for (std::size_t i = 0; i < wanted_.size(); ++i, pace()) {
      const Triangle& t = wanted_[i];
      const Vec3& a = feet_[t[0]].point;
      const Vec3 n = unit_normal(a, feet_[t[1]].point, feet_[t[2]].point);
      const double cosine = dot(nearest[i].normal, n) * (turned_[i] ? -1 : 1);
      known_[t] = std::abs(nearest[i].deviation) > tolerance_ && n != Vec3(0, 0, 0) && cosine < across;
    }
  }
  /// @return false too for triangles that were never asked about
  bool operator()(const Triangle& t) const {
    const auto found = known_.find(sorted(t));
    return found != known_.end() && found->second;
  }

 private:
  static bool is_odd(const Triangle& t) { return ((t[0] > t[1]) + (t[1] > t[2]) + (t[0] > t[2])) % 2 == 1; }
  static Triangle sorted(Triangle t) {
    std::sort(t.begin(), t.end());
    return t;
  }

  std::span<const Foot> feet_;
  const Registration& registration_;
  double tolerance_;
  QuietContext quiet_;
  std::unordered_map<Triangle, bool, TripleHash> known_;
  std::vector<Triangle> wanted_;
  std::vector<bool> turned_;
  std::vector<Vec3> middles_;
};

/// The part of a mesh around some of its triangles, with vertices and triangles numbered anew. What lies at its rim is
/// there to tell which edges exist, and is not changed.
class BridgeZone {
 public:
  BridgeZone(const PointMesh& mesh, std::span<const Foot> feet, std::span<const std::uint32_t> seeds, int steps,
             const Context& context) {
    Pace pace(context);
    // The core: `steps` triangles around the seeds, across edges.
    std::vector<std::uint8_t> state(mesh.triangles.size(), 0);  // 1: may change; 2: at the rim
    std::vector<std::uint32_t> front(seeds.begin(), seeds.end()), next;
    for (std::uint32_t t : front) state[t] = 1;
    for (int step = 0; step < steps; ++step) {
      next.clear();
      for (std::uint32_t t : front)
        for (std::int32_t n : mesh.neighbors[t])
          if (n >= 0 && !state[n]) state[n] = 1, next.push_back(static_cast<std::uint32_t>(n));
      front.swap(next);
    }
    std::vector<bool> inner(feet.size(), false);
    for (std::size_t t = 0; t < state.size(); ++t, pace())
      if (state[t])
        for (std::uint32_t v : mesh.triangles[t]) inner[v] = true;
    for (std::size_t t = 0; t < state.size(); ++t, pace()) {
      const Triangle& q = mesh.triangles[t];
      if (!state[t] && (inner[q[0]] || inner[q[1]] || inner[q[2]])) state[t] = 2;
    }

    std::vector<std::int32_t> number(mesh.triangles.size(), -1), vertex(feet.size(), -1);
    for (std::uint32_t t = 0; t < state.size(); ++t, pace()) {
      if (!state[t]) continue;
      number[t] = static_cast<std::int32_t>(triangles.size());
      triangles.push_back(t);
      changeable.push_back(state[t] == 1);
      Triangle local;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangles[t][k];
        if (vertex[v] < 0) {
          vertex[v] = static_cast<std::int32_t>(edit.vertices.size());
          edit.vertices.push_back({feet[v].point, feet[v].normal, 0, static_cast<std::int32_t>(v)});
        }
        local[k] = static_cast<std::uint32_t>(vertex[v]);
      }
      edit.triangles.push_back(local);
    }
    for (std::uint32_t t : triangles) {
      pace();
      std::array<std::int32_t, 3> row;
      for (int k = 0; k < 3; ++k) row[k] = mesh.neighbors[t][k] < 0 ? -1 : number[mesh.neighbors[t][k]];
      edit.neighbors.push_back(row);
    }
    edit.creases.assign(edit.triangles.size(), 0);
    edit.index_vertices();
  }

  /// Of a triangle of the mesh that is here.
  std::int32_t number_here(std::uint32_t t) const {
    return static_cast<std::int32_t>(std::lower_bound(triangles.begin(), triangles.end(), t) - triangles.begin());
  }

  void give_back(PointMesh& mesh) const {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint32_t t = triangles[i];
      for (int k = 0; k < 3; ++k) {
        const std::int32_t n = edit.neighbors[i][k];
        mesh.triangles[t][k] = static_cast<std::uint32_t>(edit.vertices[edit.triangles[i][k]].point);
        if (n >= 0 || changeable[i]) mesh.neighbors[t][k] = n < 0 ? -1 : static_cast<std::int32_t>(triangles[n]);
      }
    }
  }

  EditMesh edit;
  std::vector<std::uint32_t> triangles;  ///< of the mesh, ascending
  std::vector<bool> changeable;
};

class Lessener {
 public:
  Lessener(BridgeZone& zone, std::span<const Vec3> points, BridgeTest& test, const Context& context)
      : zone_(zone), mesh_(zone.edit), test_(test), cost_(zone.edit) {
    for (const EditMesh::Vertex& v : mesh_.vertices) positions_.push_back(points[v.point]);
    std::vector<std::uint32_t> all(mesh_.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    search_.emplace(positions_, mesh_.triangles, std::move(all), &context);
  }

  /// Works on regions of at most so many ring vertices until no bridging triangle is left or none can be helped.
  void run(std::span<const int> limits, const Context& context) {
    std::vector<std::int32_t> work = bridging();
    std::size_t done = 0;
    for (int round = 0; round < most_rounds && !work.empty(); ++round) {
      std::vector<std::int32_t> changed;
      for (std::int32_t t : work)
        for (int limit : limits) {
          if (++done % 32 == 0) context.checkpoint();
          if (is_bridging(t) && improve(t, limit, Aim::bridges))
            changed.insert(changed.end(), region_.begin(), region_.end());
        }
      std::sort(changed.begin(), changed.end());
      changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
      std::erase_if(changed, [&](std::int32_t t) { return !is_bridging(t); });
      work = std::move(changed);
    }
  }

  /// Works on regions around triangles that cross others, until none does or hardly any can be helped.
  /// @return whether anything changed
  bool run_crossings(const std::vector<std::uint32_t>& tangled, const Context& context) {
    std::size_t in_vain = 0;
    bool changed = false;
    for (std::uint32_t t : tangled) {
      const std::int32_t here = zone_.number_here(t);
      for (int limit : small_rings) {
        context.checkpoint();
        if (in_vain >= most_in_vain || search_->count(mesh_.triangles[here], {}) == 0) break;
        const bool helped = improve(here, limit, Aim::crossings);
        in_vain = helped ? 0 : in_vain + 1;
        changed |= helped;
      }
    }
    return changed;
  }

  std::vector<std::int32_t> bridging() const {
    std::vector<std::int32_t> found;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      if (zone_.changeable[t] && is_bridging(static_cast<std::int32_t>(t)))
        found.push_back(static_cast<std::int32_t>(t));
    return found;
  }
  double bridging_area() const {
    double sum = 0;
    for (std::int32_t t : bridging()) sum += area(mesh_.triangles[t]);
    return sum;
  }

 private:
  bool is_bridging(std::int32_t t) const { return test_(points(mesh_.triangles[t])); }

  /// What has to become less: the sum of the weights with no more crossings than before, or the crossings.
  enum class Aim { bridges, crossings };

  /// @return whether the region around `t` was changed
  bool improve(std::int32_t t, int limit, Aim aim) {
    grow(t, limit);
    const int n = static_cast<int>(ring_.size());
    if (n < 4) return false;
    find_beyond();
    ask_region();
    double before = 0;
    for (std::int32_t r : region_) before += weight(mesh_.triangles[r]);
    for (std::int32_t r : region_)
      for (int k = 0; k < 3; ++k) {
        const std::int32_t o = mesh_.neighbors[r][k];
        if (o >= 0) before += (in_region(o) ? 0.5 : 1) * fold(side_of(mesh_.triangles[r]), side_of(mesh_.triangles[o]));
      }
    const double most = aim == Aim::bridges ? before * (1 - 1e-7) : before * most_rise;
    weigh_all(most);
    patch_.clear();
    for (std::int32_t r : region_) patch_.push_back(mesh_.triangles[r]);
    const long crossings = count_crossings();
    forbidden_.clear();
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
      chosen_.clear();
      const auto best = triangulate_polygon<double>(
          n, [&](int i, int j) { return !taken_[static_cast<std::size_t>(i * n + j)]; },
          [&](int i, int k, int j, int apex_ik, int apex_kj) -> std::optional<double> {
            const Choice& own = choices_[choice(i, k, j)];
            if (own.weight == infinity) return std::nullopt;
            if (std::find(forbidden_.begin(), forbidden_.end(), RingTriangle{i, k, j}) != forbidden_.end())
              return std::nullopt;
            double sum = own.weight;
            sum += fold(own.side, apex_ik < 0 ? beyond_side_[i] : choices_[choice(i, apex_ik, k)].side);
            sum += fold(own.side, apex_kj < 0 ? beyond_side_[k] : choices_[choice(k, apex_kj, j)].side);
            if (i == 0 && j == n - 1) sum += fold(own.side, beyond_side_[n - 1]);
            return sum;
          },
          chosen_);
      if (!best || !(*best < most)) return false;
      patch_.clear();
      for (const RingTriangle& c : chosen_) patch_.push_back({ring_[c[0]], ring_[c[1]], ring_[c[2]]});
      const long now = count_crossings();
      if (now > crossings || (aim == Aim::crossings && now == crossings)) {  // what crosses is forbidden, and the next
                                                                             // best tried
        for (std::size_t c = 0; c < chosen_.size(); ++c)
          if (crossing_[c]) forbidden_.push_back(chosen_[c]);
        continue;
      }
      mesh_.replace(region_, patch_);
      for (std::int32_t r : region_) search_->note_change(static_cast<std::uint32_t>(r));
      if (search_->changes() > most_changes + mesh_.triangles.size() / 64) search_->refresh();
      return true;
    }
    return false;
  }
  Triangle points(const Triangle& t) const {
    Triangle p;
    for (int k = 0; k < 3; ++k) p[k] = static_cast<std::uint32_t>(mesh_.vertices[t[k]].point);
    return p;
  }
  bool in_region(std::int32_t t) const { return std::find(region_.begin(), region_.end(), t) != region_.end(); }

  double weight(const Triangle& t) { return plain_weight(t) + (test_(points(t)) ? bridge_weight * area(t) : 0); }
  double plain_weight(const Triangle& t) {
    for (std::uint32_t v : t) measure_area(v);
    return cost_(t);
  }

  /// How a triangle lies, for folds against others. No area where there is none.
  struct Side {
    Vec3 normal{0, 0, 0};
    double area = 0;
  };
  Side side_of(const Triangle& t) const {
    const Vec3& a = mesh_.vertices[t[0]].p;
    const Vec3 n = (mesh_.vertices[t[1]].p - a) % (mesh_.vertices[t[2]].p - a);
    const double length = n.norm();
    return {length > 0 ? Vec3(n / length) : n, 0.5 * length};
  }
  bool may_bridge(const Side& side, const Triangle& t) const {
    const auto& v = mesh_.vertices;
    return disagrees(side.normal, 1, v[t[0]].normal, v[t[1]].normal, v[t[2]].normal);
  }
  void ask_region() {
    wanted_.clear();
    for (std::int32_t r : region_)
      if (may_bridge(side_of(mesh_.triangles[r]), mesh_.triangles[r])) wanted_.push_back(points(mesh_.triangles[r]));
    test_.ask(wanted_);
  }
  static double fold(const Side& s, const Side& t) {
    return (s.normal | t.normal) < fold_cosine ? fold_weight * std::min(s.area, t.area) : 0;
  }

  /// A triangle over the ring; infinite weight: it cannot be part of anything better than what is there.
  struct Choice {
    double weight = infinity;
    Side side;
  };
  /// Position of ring triangle i < k < j in `choices_`.
  static std::size_t choice(int i, int k, int j) {
    return static_cast<std::size_t>(j * (j - 1) * (j - 2) / 6 + k * (k - 1) / 2 + i);
  }
  void weigh_all(double limit) {
    const int n = static_cast<int>(ring_.size());
    choices_.assign(choice(0, 1, n), Choice());
    wanted_.clear();
    weighed_.clear();
    const auto possible = [&](int i, int j) { return j == i + 1 || (i == 0 && j == n - 1) || !taken_[i * n + j]; };
    const auto weigh = [&](Choice& c, int i, int k, int j) {
      if (!possible(i, k) || !possible(k, j) || !possible(i, j)) return;
      const Triangle q{ring_[i], ring_[k], ring_[j]};
      const double own = plain_weight(q);
      if (own >= limit) return;
      c = {own, side_of(q)};
      if (!may_bridge(c.side, q)) return;
      wanted_.push_back(points(q));
      weighed_.push_back(&c);
    };
    for (int j = 2; j < n; ++j)
      for (int k = 1; k < j; ++k)
        for (int i = 0; i < k; ++i) weigh(choices_[choice(i, k, j)], i, k, j);
    test_.ask(wanted_);
    for (std::size_t w = 0; w < wanted_.size(); ++w)
      if (test_(wanted_[w])) weighed_[w]->weight += bridge_weight * weighed_[w]->side.area;
  }

  /// Crossings of the patch with itself and what lies outside the region; notes the triangles that cross.
  long count_crossings() {
    long sum = 0;
    crossing_.assign(patch_.size(), false);
    for (std::size_t i = 0; i < patch_.size(); ++i) {
      const long own = search_->count(patch_[i], region_);
      sum += own;
      if (own > 0) crossing_[i] = true;
      for (std::size_t j = 0; j < i; ++j) {
        const Triangle &q = patch_[i], &r = patch_[j];
        if (std::find_first_of(q.begin(), q.end(), r.begin(), r.end()) != q.end()) continue;
        if (!triangles_intersect(corners(q), corners(r))) continue;
        crossing_[i] = true;
        ++sum;
      }
    }
    return sum;
  }
  std::array<Vec3, 3> corners(const Triangle& t) const {
    return {positions_[t[0]], positions_[t[1]], positions_[t[2]]};
  }
  double area(const Triangle& t) const {
    const Vec3& a = mesh_.vertices[t[0]].p;
    return 0.5 * ((mesh_.vertices[t[1]].p - a) % (mesh_.vertices[t[2]].p - a)).norm();
  }
  /// A third of the star at the first asking; it keeps that, so that costs can be compared later.
  void measure_area(std::uint32_t v) {
    if (mesh_.vertices[v].area > 0) return;
    EditMesh::Star star;
    mesh_.star(v, star, std::numeric_limits<std::size_t>::max());
    double sum = 0;
    for (std::int32_t t : star.fan) sum += area(mesh_.triangles[t]);
    mesh_.vertices[v].area = static_cast<float>(sum / 3);
  }

  /// A disc around `t`, without a vertex inside and with each ring vertex once.
  void grow(std::int32_t t, int limit) {
    region_.assign(1, t);
    const Triangle& q = mesh_.triangles[t];
    ring_.assign(q.begin(), q.end());
    // Triangles across the ring, nearest in steps first, those that bridge before others.
    queue_.clear();
    push_around(t);
    while (!queue_.empty() && static_cast<int>(ring_.size()) < limit) {
      std::size_t pick = 0;
      for (std::size_t i = 0; i < queue_.size(); ++i)
        if (is_bridging(queue_[i])) {
          pick = i;
          break;
        }
      const std::int32_t next = queue_[pick];
      queue_.erase(queue_.begin() + static_cast<std::ptrdiff_t>(pick));
      if (in_region(next)) continue;
      // It must meet the region in one ring edge, its apex being new.
      const Triangle& r = mesh_.triangles[next];
      std::size_t at = ring_.size();
      std::uint32_t apex = 0;
      for (std::size_t i = 0; i < ring_.size(); ++i) {
        const std::uint32_t a = ring_[i], b = ring_[(i + 1) % ring_.size()];
        for (int k = 0; k < 3; ++k)
          if (r[(k + 1) % 3] == b && r[(k + 2) % 3] == a) at = i, apex = r[k];
      }
      if (at == ring_.size() || std::find(ring_.begin(), ring_.end(), apex) != ring_.end()) continue;
      ring_.insert(ring_.begin() + static_cast<std::ptrdiff_t>(at) + 1, apex);
      region_.push_back(next);
      push_around(next);
    }
  }
  void push_around(std::int32_t t) {
    for (std::int32_t n : mesh_.neighbors[t])
      if (n >= 0 && zone_.changeable[n] && !in_region(n)) queue_.push_back(n);
  }

  /// What lies beyond each ring edge, and which chords are edges outside the region.
  void find_beyond() {
    const std::size_t n = ring_.size();
    beyond_side_.assign(n, Side());
    taken_.assign(n * n, false);
    for (std::size_t i = 0; i < n; ++i) {
      EditMesh::Star star;
      mesh_.star(ring_[i], star, std::numeric_limits<std::size_t>::max());
      for (std::int32_t t : star.fan) {
        if (in_region(t)) continue;
        const Triangle& q = mesh_.triangles[t];
        for (int k = 0; k < 3; ++k)
          if (q[(k + 1) % 3] == ring_[(i + 1) % n] && q[(k + 2) % 3] == ring_[i]) beyond_side_[i] = side_of(q);
        for (std::size_t j = 0; j < n; ++j)
          if (j != i && (q[0] == ring_[j] || q[1] == ring_[j] || q[2] == ring_[j]))
            taken_[i * n + j] = taken_[j * n + i] = true;
      }
    }
  }

  BridgeZone& zone_;
  EditMesh& mesh_;
  BridgeTest& test_;
  TriangleCost cost_;
  std::vector<std::int32_t> region_, queue_;
  std::vector<Side> beyond_side_;
  std::vector<Choice> choices_;
  std::vector<Choice*> weighed_;  // as `wanted_`
  std::vector<std::uint32_t> ring_;
  std::vector<bool> taken_, crossing_;
  std::vector<Triangle> wanted_, patch_;
  std::vector<RingTriangle> chosen_, forbidden_;
  std::vector<Vec3> positions_;
  std::optional<CrossingSearch> search_;
};

/// The triangles that may bridge, and the area of all.
std::vector<std::uint32_t> find_suspicious(std::span<const Foot> feet, const PointMesh& mesh, double& total_area,
                                           const Context& context) {
  const std::size_t blocks = (mesh.triangles.size() + triangles_block - 1) / triangles_block;
  std::vector<std::vector<std::uint32_t>> found(blocks);
  std::vector<double> area(blocks, 0);
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t i) {
    context.checkpoint();
    for (std::size_t t = i * triangles_block; t < std::min(mesh.triangles.size(), (i + 1) * triangles_block); ++t) {
      const Triangle& q = mesh.triangles[t];
      const Foot &a = feet[q[0]], &b = feet[q[1]], &c = feet[q[2]];
      const Vec3 n = (b.point - a.point) % (c.point - a.point);
      const double twice_area = n.norm();
      area[i] += 0.5 * twice_area;
      if (disagrees(n, twice_area, a.normal, b.normal, c.normal)) found[i].push_back(static_cast<std::uint32_t>(t));
    }
  });
  std::vector<std::uint32_t> all;
  for (std::size_t i = 0; i < blocks; ++i) {
    all.insert(all.end(), found[i].begin(), found[i].end());
    total_area += area[i];
  }
  return all;
}

}  // namespace

Bridges lessen_bridges(std::span<const Vec3> points, std::span<const Foot> feet, const Registration& registration,
                       double tolerance, PointMesh& mesh, Context& context) {
  Pace pace(context);
  Bridges bridges;
  std::vector<std::uint32_t> seeds = find_suspicious(feet, mesh, bridges.total_area, context);
  BridgeTest test(feet, registration, tolerance, context);
  std::vector<Triangle> asked;
  for (std::uint32_t t : seeds) pace(), asked.push_back(mesh.triangles[t]);
  test.ask(asked);
  std::erase_if(seeds, [&](std::uint32_t t) { return pace(), !test(mesh.triangles[t]); });
  if (seeds.empty()) return bridges;
  BridgeZone zone(mesh, feet, seeds, zone_steps, context);
  Lessener lessener(zone, points, test, context);
  context.checkpoint();
  lessener.run(small_rings, context);
  if (lessener.bridging_area() > much * bridges.total_area) lessener.run(large_rings, context);
  zone.give_back(mesh);
  bridges.triangles = lessener.bridging().size();
  bridges.area = lessener.bridging_area();
  return bridges;
}

bool mend_crossings(std::span<const Vec3> points, std::span<const Foot> feet, const Registration& registration,
                    double tolerance, std::span<const std::array<std::uint32_t, 2>> pairs, PointMesh& mesh,
                    Context& context) {
  if (pairs.empty()) return false;
  Pace pace(context);
  DisjointSets parts(points.size());
  for (const Triangle& t : mesh.triangles) pace(), parts.join(t[0], t[1]), parts.join(t[0], t[2]);
  std::vector<std::uint32_t> tangled;
  for (const auto& pair : pairs)
    if (parts.find(mesh.triangles[pair[0]][0]) == parts.find(mesh.triangles[pair[1]][0]))
      tangled.insert(tangled.end(), pair.begin(), pair.end());
  if (tangled.empty()) return false;
  std::sort(tangled.begin(), tangled.end());
  tangled.erase(std::unique(tangled.begin(), tangled.end()), tangled.end());
  BridgeTest test(feet, registration, tolerance, context);
  BridgeZone zone(mesh, feet, tangled, zone_steps, context);
  Lessener lessener(zone, points, test, context);
  context.checkpoint();
  bool changed = false;
  for (int round = 0; round < most_crossing_rounds && lessener.run_crossings(tangled, context); ++round) changed = true;
  if (changed) zone.give_back(mesh);
  return changed;
}

}  // namespace tri
