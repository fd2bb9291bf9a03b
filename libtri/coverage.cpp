#include "libtri/coverage.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "meshops/disjoint_sets.hpp"
#include "meshops/nearest_points.hpp"

namespace tri {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Shape3 {
  float circumradius = 0, longest = 0, shortest = 0;
};

Shape3 shape_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  const double twice_area = ((b - a) % (c - a)).norm();
  Shape3 s;
  s.longest = static_cast<float>(std::max({ab, bc, ca}));
  s.shortest = static_cast<float>(std::min({ab, bc, ca}));
  // A needle's circumcircle says nothing about the points around it.
  if (twice_area > 0) s.circumradius = static_cast<float>(ab * bc * ca / (2 * twice_area));
  if (!(twice_area > 0) || s.circumradius > s.longest) s.circumradius = s.longest;
  return s;
}

/// Triangles around each vertex, as one array with offsets.
struct Stars {
  std::vector<std::uint32_t> start, items;
  Stars(const std::vector<Triangle>& triangles, std::size_t vertices)
      : start(vertices + 1, 0), items(3 * triangles.size()) {
    for (const Triangle& t : triangles)
      for (std::uint32_t v : t) ++start[v + 1];
    for (std::size_t v = 0; v < vertices; ++v) start[v + 1] += start[v];
    std::vector<std::uint32_t> fill(start.begin(), start.end() - 1);
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::uint32_t v : triangles[t]) items[fill[v]++] = t;
  }
  std::span<const std::uint32_t> of(std::uint32_t v) const {
    return {items.data() + start[v], items.data() + start[v + 1]};
  }
};

/// A few values on the stack; of a fan with more, those that come first.
class Few {
 public:
  void add(float x) {
    if (size_ == values_.size()) return;
    std::size_t i = size_++;
    for (; i > 0 && values_[i - 1] > x; --i) values_[i] = values_[i - 1];
    values_[i] = x;
  }
  bool empty() const { return size_ == 0; }
  float lower_median() const { return values_[(size_ - 1) / 2]; }

 private:
  std::array<float, 24> values_;
  std::size_t size_ = 0;
};

std::vector<Shape3> shapes_of(const PointMesh& mesh, std::span<const Vec3> places) {
  std::vector<Shape3> shapes(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, shapes.size(), [&](std::size_t t) {
    const Triangle& q = mesh.triangles[t];
    shapes[t] = shape_of(places[q[0]], places[q[1]], places[q[2]]);
  });
  return shapes;
}

/// The spacing of points from the circumcircles around them.
class Spacing {
 public:
  Spacing(const PointMesh& mesh, const std::vector<Shape3>& shapes, const Stars& stars)
      : mesh_(mesh),
        stars_(stars),
        own_(stars.start.size() - 1, 0),
        lowest_(own_.size(), 0),
        around_(own_.size(), -1),
        seen_(own_.size(), 0) {
    // Between scan lines the circle through three points spans the distance of the lines; on scattered points it is
    // smaller than the spacing, by 0.6 in the median of a Poisson process.
    constexpr float scattered = 1.5f, lines = 2.0f, elongated = 0.3f;
    const tbb::blocked_range<std::uint32_t> all(0, static_cast<std::uint32_t>(own_.size()), 4096);
    tbb::parallel_for(all, [&](const auto& range) {
      for (std::uint32_t v = range.begin(); v < range.end(); ++v) {
        Few radii, ratios;
        for (std::uint32_t t : stars.of(v)) {
          radii.add(shapes[t].circumradius);
          ratios.add(shapes[t].circumradius > 0 ? shapes[t].shortest / shapes[t].circumradius : 1);
        }
        if (!radii.empty()) own_[v] = radii.lower_median() * (ratios.lower_median() < elongated ? lines : scattered);
      }
    });
    std::vector<float> smooth(own_.size(), 0);
    tbb::parallel_for(all, [&](const auto& range) {
      for (std::uint32_t v = range.begin(); v < range.end(); ++v) {
        Few around;
        for (std::uint32_t t : stars.of(v)) {
          const Triangle& q = mesh.triangles[t];
          around.add(own_[q[0] == v ? q[1] : q[1] == v ? q[2] : q[0]]);
        }
        if (!around.empty()) smooth[v] = around.lower_median();
      }
    });
    lowest_ = smooth;
    for (const Triangle& t : mesh.triangles) {
      const float least = std::min({smooth[t[0]], smooth[t[1]], smooth[t[2]]});
      for (std::uint32_t v : t) lowest_[v] = std::min(lowest_[v], least);
    }
  }

  /// A cheap value that hardly ever is above `at(t)`.
  float lowest(const Triangle& t) const { return std::min({lowest_[t[0]], lowest_[t[1]], lowest_[t[2]]}); }

  /// The median over the nearest vertices along edges. They reach beyond those around a gap, whose own circles span it.
  float at(std::uint32_t v) {
    constexpr std::size_t enough = 40;
    if (around_[v] >= 0) return around_[v];
    if (stars_.of(v).empty()) return around_[v] = 0;
    ++round_;
    queue_.assign(1, v);
    seen_[v] = round_;
    for (std::size_t i = 0; i < queue_.size() && queue_.size() < enough; ++i)
      for (std::uint32_t t : stars_.of(queue_[i]))
        for (std::uint32_t w : mesh_.triangles[t])
          if (seen_[w] != round_) seen_[w] = round_, queue_.push_back(w);
    values_.clear();
    for (std::uint32_t w : queue_) values_.push_back(own_[w]);
    const auto middle = values_.begin() + static_cast<std::ptrdiff_t>((values_.size() - 1) / 2);
    std::nth_element(values_.begin(), middle, values_.end());
    return around_[v] = *middle;
  }
  float at(const Triangle& t) { return std::max({at(t[0]), at(t[1]), at(t[2])}); }

 private:
  const PointMesh& mesh_;
  const Stars& stars_;
  std::vector<float> own_, lowest_, around_, values_;
  std::vector<std::uint32_t> seen_, queue_;
  std::uint32_t round_ = 0;
};

/// A place on the model and how far it is to the nearest point or free edge.
struct Disc {
  Vec3 center{0, 0, 0};
  std::array<float, 3> normal{};
  double radius = 0, spacing = 0;
  std::uint32_t triangle = 0;
  std::int32_t face = -1;
};

double cosine(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool same_side(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return cosine(a, b) > 0.3;
}

/// Distance from places on the model to the nearest measured point that does not face the other way, and to free edges.
class EmptyDiscs {
 public:
  /// @param reach  mm: points farther than this from every one of `probes` are only looked at where nothing else is
  /// found
  EmptyDiscs(const CadModel& model, std::span<const Foot> feet, std::span<const Foot> probes, double reach, double step)
      : feet_(feet), reach_(reach), farthest_(model.diagonal), few_(probes.size() < feet.size() / 16) {
    std::unordered_set<std::uint64_t> near_probes;
    const auto cell = [&](const Vec3& p, int dx, int dy, int dz) {
      const auto at = [&](int k, int d) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(p[k] / reach)) + d) & 0x1fffff;
      };
      return at(0, dx) << 42 | at(1, dy) << 21 | at(2, dz);
    };
    // Few probes, as on a part that was measured everywhere, need few points; trees over all would cost more than all
    // else.
    if (few_)
      for (const Foot& probe : probes)
        for (int i = 0; i < 27; ++i) near_probes.insert(cell(probe.point, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
    fill_bins([&](const Foot& foot) { return !few_ || near_probes.contains(cell(foot.point, 0, 0, 0)); });
    for (const CadEdge& edge : model.edges)
      if (edge.faces.size() == 1 && !edge.degenerate)
        for (std::size_t k = 0; k + 1 < edge.polyline.size(); ++k) {
          const Vec3 d = edge.polyline[k + 1] - edge.polyline[k];
          const int n = std::clamp(static_cast<int>(std::ceil(d.norm() / step)), 1, 10000);
          for (int i = 0; i <= n; ++i) rim_.push_back(edge.polyline[k] + d * (static_cast<double>(i) / n));
        }
    if (!rim_.empty()) rim_tree_.emplace(rim_);
  }

  /// What ends the largest disc about a place.
  struct End {
    double distance = 0;
    Vec3 place{0, 0, 0};
    std::int32_t point = -1;  // -1 at a free edge, or where nothing ends it
  };
  End end(const Foot& at) {
    End nearest{farthest_, at.point, -1};
    if (rim_tree_) {
      rim_tree_->nearest(at.point, 1, found_);
      const double distance = std::sqrt(found_[0].squared_distance);
      if (distance < nearest.distance) nearest = {distance, rim_[found_[0].index], -1};
    }
    const End found = nearest_point(at, nearest);
    if (!few_ || found.distance <= reach_) return found;
    few_ = false;
    fill_bins([](const Foot&) { return true; });
    return nearest_point(at, nearest);
  }

 private:
  static constexpr double other_way = 1.9;  // radians: normals farther apart are those of two sides of a wall

  struct Bin {  // of points with similar normals
    std::vector<Vec3> places;
    std::vector<std::array<float, 3>> normals;
    std::vector<std::int32_t> points;
    std::array<float, 3> middle{};
    double spread = 0;  // radians, of the normals about the middle
    std::optional<NearestPoints> tree;

    void clear() {
      tree.reset();
      places.clear();
      normals.clear();
      points.clear();
      spread = 0;
    }
    void finish() {
      if (places.empty()) return;
      Vec3 sum(0, 0, 0);
      for (const auto& n : normals) sum += Vec3(n[0], n[1], n[2]);
      if (sum.norm() > 0) sum /= sum.norm();
      for (int k = 0; k < 3; ++k) middle[k] = static_cast<float>(sum[k]);
      for (const auto& n : normals) spread = std::max(spread, std::acos(std::clamp(cosine(n, middle), -1.0, 1.0)));
      tree.emplace(places);
    }
  };
  static constexpr int cells = 3;  // along each side of a cube around the directions

  static std::size_t bin_of(const std::array<float, 3>& n) {
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(n[k]) > std::abs(n[axis])) axis = k;
    const auto cell = [&](int k) {
      return n[axis] == 0 ? 0
                          : std::clamp(static_cast<int>((n[k] / std::abs(n[axis]) + 1) * 0.5f * cells), 0, cells - 1);
    };
    return static_cast<std::size_t>(((2 * axis + (n[axis] < 0)) * cells + cell((axis + 1) % 3)) * cells +
                                    cell((axis + 2) % 3));
  }

  template <class Wanted>
  void fill_bins(Wanted wanted) {
    for (Bin& bin : bins_) bin.clear();
    for (std::size_t i = 0; i < feet_.size(); ++i) {
      const Foot& foot = feet_[i];
      if (foot.face < 0 || !wanted(foot)) continue;
      Bin& bin = bins_[bin_of(foot.normal)];
      bin.places.push_back(foot.point);
      bin.normals.push_back(foot.normal);
      bin.points.push_back(static_cast<std::int32_t>(i));
    }
    for (Bin& bin : bins_) bin.finish();
  }

  /// @return the nearest point that counts, or `nearest` if that is nearer
  End nearest_point(const Foot& at, End nearest) {
    // Bins of which every point counts come first: they bound the search in those of which only some do.
    for (const bool whole : {true, false})
      for (const Bin& bin : bins_) {
        if (bin.places.empty()) continue;
        const double angle = std::acos(std::clamp(cosine(at.normal, bin.middle), -1.0, 1.0));
        if (angle - bin.spread > other_way || whole != (angle + bin.spread < other_way)) continue;
        for (std::size_t k = whole ? 1 : 8;; k *= 8) {
          bin.tree->nearest(at.point, k, found_);
          const auto counts = std::find_if(found_.begin(), found_.end(), [&](const NearestPoints::Neighbor& n) {
            return whole || n.squared_distance >= nearest.distance * nearest.distance ||
                   cosine(bin.normals[n.index], at.normal) > std::cos(other_way);
          });
          if (counts != found_.end() && counts->squared_distance < nearest.distance * nearest.distance)
            nearest = {std::sqrt(counts->squared_distance), bin.places[counts->index], bin.points[counts->index]};
          if (counts != found_.end() || found_.size() < k) break;
        }
      }
    return nearest;
  }

  std::span<const Foot> feet_;
  double reach_;
  double farthest_;
  bool few_;
  std::array<Bin, 6 * cells * cells> bins_;
  std::vector<Vec3> rim_;
  std::optional<NearestPoints> rim_tree_;
  std::vector<NearestPoints::Neighbor> found_;
};

std::array<float, 3> facing(const Triangle& q, std::span<const Vec3> places) {
  const Vec3 n = (places[q[1]] - places[q[0]]) % (places[q[2]] - places[q[0]]);
  const double length = n.norm();
  std::array<float, 3> result{};
  if (length > 0)
    for (int k = 0; k < 3; ++k) result[k] = static_cast<float>(n[k] / length);
  return result;
}

bool opposed(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return cosine(a, b) < -0.3;
}

/// Where a whole side of the part was not measured, the triangles that stand for it lie along the other side: their
/// probes are sent on, the way the triangles face, until they meet a place of the model that faces so too.
/// @return whether any was
bool send_through(const PointMesh& mesh, std::span<const Vec3> places, double diagonal, double step,
                  std::span<const Vec3> probes, std::span<const std::uint32_t> probe_triangle,
                  const Registration& registration, std::vector<Foot>& feet, Context& context) {
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t i = 0; i < probes.size(); ++i)
    if (feet[i].face >= 0 && opposed(feet[i].normal, facing(mesh.triangles[probe_triangle[i]], places)))
      waiting.push_back(i);
  bool any = false;
  for (double s = std::max(step, 1e-4 * diagonal); s < diagonal && !waiting.empty(); s *= 1.5) {
    std::vector<Vec3> ahead;
    for (std::uint32_t i : waiting) {
      const auto n = facing(mesh.triangles[probe_triangle[i]], places);
      ahead.push_back(probes[i] + Vec3(n[0], n[1], n[2]) * s);
    }
    const std::vector<Foot> met = registration.register_points(ahead, context);
    std::vector<std::uint32_t> still;
    for (std::size_t k = 0; k < waiting.size(); ++k) {
      if (met[k].face >= 0 && same_side(met[k].normal, facing(mesh.triangles[probe_triangle[waiting[k]]], places))) {
        feet[waiting[k]] = met[k];
        any = true;
      } else {
        still.push_back(waiting[k]);
      }
    }
    waiting = std::move(still);
  }
  return any;
}

/// Closes triangles again until the open ones leave no vertex without a triangle and no vertex with two fans.
void keep_manifold(const PointMesh& mesh, const Stars& stars, std::vector<bool>& open, const std::vector<float>& size) {
  std::set<std::uint32_t> work;
  for (std::uint32_t t = 0; t < open.size(); ++t)
    if (open[t]) work.insert(mesh.triangles[t].begin(), mesh.triangles[t].end());
  const auto corner = [&](std::uint32_t t, std::uint32_t v) {
    const Triangle& q = mesh.triangles[t];
    return q[0] == v ? 0 : q[1] == v ? 1 : 2;
  };
  while (!work.empty()) {
    const std::uint32_t v = *work.begin();
    work.erase(work.begin());
    // The fan in order, beginning at the boundary if there is one.
    const auto star = stars.of(v);
    std::uint32_t first = star[0];
    for (std::size_t steps = 0; steps < star.size(); ++steps) {
      const std::int32_t previous = mesh.neighbors[first][(corner(first, v) + 2) % 3];
      if (previous < 0) break;
      first = static_cast<std::uint32_t>(previous);
    }
    std::vector<std::uint32_t> fan{first};
    bool closed = false;
    while (true) {
      const std::int32_t next = mesh.neighbors[fan.back()][(corner(fan.back(), v) + 1) % 3];
      closed = next == static_cast<std::int32_t>(first);
      if (next < 0 || closed || fan.size() > star.size()) break;
      fan.push_back(static_cast<std::uint32_t>(next));
    }
    if (closed) {  // begin at the first triangle of a run
      std::size_t turn = 0;
      while (turn < fan.size() && !(open[fan[turn]] != open[fan[(turn + fan.size() - 1) % fan.size()]])) ++turn;
      if (turn < fan.size()) std::rotate(fan.begin(), fan.begin() + static_cast<std::ptrdiff_t>(turn), fan.end());
    }
    struct Run {
      std::size_t begin, end;
      float size;
    };
    std::vector<Run> open_runs;
    std::size_t kept_runs = 0;
    for (std::size_t i = 0; i < fan.size();) {
      std::size_t j = i;
      float largest = 0;
      while (j < fan.size() && open[fan[j]] == open[fan[i]]) largest = std::max(largest, size[fan[j++]]);
      if (open[fan[i]]) {
        open_runs.push_back({i, j, largest});
      } else {
        ++kept_runs;
      }
      i = j;
    }
    const auto close = [&](std::uint32_t t) {
      open[t] = false;
      work.insert(mesh.triangles[t].begin(), mesh.triangles[t].end());
    };
    if (kept_runs == 0) {
      close(*std::min_element(fan.begin(), fan.end(),
                              [&](std::uint32_t a, std::uint32_t b) { return size[a] < size[b]; }));
    } else if (kept_runs > 1) {
      // Two fans of kept triangles: the smallest run between two of them is closed.
      const Run* smallest = nullptr;
      for (const Run& run : open_runs) {
        const bool at_end = !closed && (run.begin == 0 || run.end == fan.size());
        if (!at_end && (!smallest || run.size < smallest->size)) smallest = &run;
      }
      if (smallest)
        for (std::size_t i = smallest->begin; i < smallest->end; ++i) close(fan[i]);
    }
  }
}

}  // namespace

std::vector<float> point_spacing(const PointMesh& mesh, std::span<const Vec3> places) {
  const Stars stars(mesh.triangles, places.size());
  Spacing spacing(mesh, shapes_of(mesh, places), stars);
  std::vector<float> result;
  for (std::uint32_t v = 0; v < places.size(); ++v) result.push_back(spacing.at(v));
  return result;
}

Coverage find_unmeasured(const CadModel& model, const Registration& registration, const PointMesh& mesh,
                         std::span<const Foot> feet, double hole_size, Context& context) {
  Coverage result;
  if (mesh.triangles.empty()) return result;
  std::vector<Vec3> places;
  for (const Foot& f : feet) places.push_back(f.point);
  const Stars stars(mesh.triangles, places.size());
  const std::vector<Shape3> shapes = shapes_of(mesh, places);
  Spacing spacing(mesh, shapes, stars);

  // Only a triangle with a large circumcircle can hold the middle of a large empty disc: probe those.
  std::vector<Vec3> probes;
  std::vector<std::uint32_t> probe_triangle;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& q = mesh.triangles[t];
    const Vec3 &a = places[q[0]], &b = places[q[1]], &c = places[q[2]];
    const Shape3& s = shapes[t];
    if (s.circumradius < 0.9 * hole_size * spacing.lowest(q)) continue;
    const double h = spacing.at(q);
    if (s.circumradius < 0.9 * hole_size * h) continue;
    const int n = std::clamp(static_cast<int>(std::ceil(s.longest / std::max(h, 1e-300))), 3, 12);
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        probes.push_back((a * i + b * j + c * (n - i - j)) / n);
        probe_triangle.push_back(t);
      }
  }
  context.checkpoint();
  if (probes.empty()) return result;
  std::vector<Foot> probe_feet = registration.register_points(probes, context);
  double finest = infinity, widest_spacing = 0;
  for (std::uint32_t t : probe_triangle) {
    const double h = spacing.at(mesh.triangles[t]);
    if (h > 0) finest = std::min(finest, h);
    widest_spacing = std::max(widest_spacing, h);
  }
  const bool sides_missing = send_through(mesh, places, model.diagonal, finest < infinity ? finest : 0, probes,
                                          probe_triangle, registration, probe_feet, context);
  EmptyDiscs empty(model, feet, probe_feet, 4 * hole_size * widest_spacing,
                   std::max(0.25 * finest, 0.01 * widest_spacing));
  std::vector<Disc> discs;
  struct Growing {
    std::uint32_t probe;
    EmptyDiscs::End end;
  };
  std::vector<Growing> growing;
  const auto spacing_of = [&](const Growing& g) {
    const double h = spacing.at(mesh.triangles[probe_triangle[g.probe]]);
    return g.end.point < 0 ? h : std::max<double>(h, spacing.at(static_cast<std::uint32_t>(g.end.point)));
  };
  const auto keep_empty = [&](const Growing& g) {
    const double h = spacing_of(g);
    const Foot& foot = probe_feet[g.probe];
    if (g.end.distance > hole_size * h)
      discs.push_back({foot.point, foot.normal, g.end.distance, h, probe_triangle[g.probe], foot.face});
    return g.end.distance > hole_size * h;
  };
  for (std::uint32_t i = 0; i < probes.size(); ++i) {
    if (probe_feet[i].face < 0) continue;
    const Growing g{i, empty.end(probe_feet[i])};
    if (!keep_empty(g) && g.end.distance > 0.5 * hole_size * spacing_of(g)) growing.push_back(g);
  }
  // Around a corner of the part triangles cut short, and their probes miss the middle of the gap: discs are pushed away
  // from what ends them as long as they grow.
  for (int round = 0; round < 6 && !growing.empty(); ++round) {
    std::vector<Vec3> pushed;
    for (const Growing& g : growing)
      pushed.push_back(probe_feet[g.probe].point + (probe_feet[g.probe].point - g.end.place) * 0.3);
    const std::vector<Foot> pushed_feet = registration.register_points(pushed, context);
    std::vector<Growing> still;
    for (std::size_t k = 0; k < growing.size(); ++k) {
      if (pushed_feet[k].face < 0) continue;
      const Growing g{growing[k].probe, empty.end(pushed_feet[k])};
      if (g.end.distance < 1.03 * growing[k].end.distance) continue;
      probe_feet[g.probe] = pushed_feet[k];
      if (!keep_empty(g)) still.push_back(g);
    }
    growing = std::move(still);
  }
  if (discs.empty()) return result;
  context.checkpoint();

  // Open: every triangle with such a place inside, and those whose middle lies in one of the discs.
  std::vector<bool> open(mesh.triangles.size(), false);
  for (const Disc& d : discs) open[d.triangle] = true;
  std::vector<Vec3> centers;
  double widest = 0;
  for (const Disc& d : discs) centers.push_back(d.center), widest = std::max(widest, d.radius);
  const NearestPoints center_tree(centers);
  std::vector<Vec3> middles;
  std::vector<std::uint32_t> middle_triangle;
  std::vector<bool>
      small_middle;  // such triangles are open only if they stand for another side than the one they lie on
  std::vector<NearestPoints::Neighbor> near;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& q = mesh.triangles[t];
    if (open[t]) continue;
    const bool small = shapes[t].longest < spacing.lowest(q) || shapes[t].longest < spacing.at(q);
    if (small && !sides_missing) continue;
    const Vec3 middle = (places[q[0]] + places[q[1]] + places[q[2]]) / 3;
    center_tree.nearest(middle, 1, near);
    if (near[0].squared_distance > widest * widest) continue;
    middles.push_back(middle);
    middle_triangle.push_back(t);
    small_middle.push_back(small);
  }
  const std::vector<Foot> middle_feet = registration.register_points(middles, context);
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const auto own = facing(mesh.triangles[middle_triangle[i]], places);
    const bool through = opposed(middle_feet[i].normal, own);
    if (small_middle[i] && !through) continue;
    center_tree.within(middle_feet[i].point, widest, near);
    for (const auto& n : near) {
      const Disc& d = discs[n.index];
      if (n.squared_distance < 0.9 * d.radius * d.radius && same_side(d.normal, through ? own : middle_feet[i].normal))
        open[middle_triangle[i]] = true;
    }
  }
  std::vector<float> size(mesh.triangles.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (open[t]) size[t] = shapes[t].circumradius;
  keep_manifold(mesh, stars, open, size);

  DisjointSets connected(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (open[t]) {
      result.open_triangles.push_back(t);
      for (std::int32_t n : mesh.neighbors[t])
        if (n >= 0 && open[n]) connected.join(t, static_cast<std::uint32_t>(n));
    }
  std::unordered_map<std::size_t, std::size_t> region_of;
  std::vector<std::set<int>> faces;
  for (const Disc& d : discs) {
    if (!open[d.triangle]) continue;
    const auto [it, fresh] = region_of.emplace(connected.find(d.triangle), result.regions.size());
    if (fresh) result.regions.emplace_back(), faces.emplace_back();
    UnmeasuredRegion& region = result.regions[it->second];
    faces[it->second].insert(model.faces[d.face].index);
    if (d.radius > region.radius) region.center = d.center, region.radius = d.radius, region.spacing = d.spacing;
  }
  for (std::size_t i = 0; i < faces.size(); ++i) result.regions[i].faces.assign(faces[i].begin(), faces[i].end());
  std::stable_sort(result.regions.begin(), result.regions.end(),
                   [](const UnmeasuredRegion& a, const UnmeasuredRegion& b) { return a.radius > b.radius; });
  return result;
}

void drop_triangles(PointMesh& mesh, std::span<const std::uint32_t> drop) {
  std::vector<std::int32_t> renumbered(mesh.triangles.size(), 0);
  for (std::uint32_t t : drop) renumbered[t] = -1;
  std::int32_t next = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (renumbered[t] < 0) continue;
    renumbered[t] = next;
    mesh.triangles[next] = mesh.triangles[t];
    mesh.neighbors[next] = mesh.neighbors[t];
    ++next;
  }
  mesh.triangles.resize(static_cast<std::size_t>(next));
  mesh.neighbors.resize(static_cast<std::size_t>(next));
  for (auto& row : mesh.neighbors)
    for (std::int32_t& n : row)
      if (n >= 0) n = renumbered[n];
}

}  // namespace tri
