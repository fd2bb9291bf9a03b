#include "libtri/triangulation/mesh_spacing.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

namespace tri {
namespace {

TriangleShape shape_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  const double twice_area = ((b - a) % (c - a)).norm();
  TriangleShape s;
  s.longest = static_cast<float>(std::max({ab, bc, ca}));
  s.shortest = static_cast<float>(std::min({ab, bc, ca}));
  if (twice_area > 0) s.circumradius = static_cast<float>(ab * bc * ca / (2 * twice_area));
  if (!(twice_area > 0) || s.circumradius > s.longest) s.circumradius = s.longest;
  return s;
}

/// A few values on the stack; of a fan with more, those that come first.
class Few {
 public:
  void add(float x) {
    if (size_ < values_.size()) values_[size_++] = x;
  }
  bool empty() const { return size_ == 0; }
  /// Most vertices have six values, in an order that no branch predicts: a network sorts up to eight without any.
  float lower_median() const {
    const std::size_t middle = (size_ - 1) / 2;
    if (size_ > 8) {
      std::array<float, 24> sorted = values_;
      std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(middle),
                       sorted.begin() + static_cast<std::ptrdiff_t>(size_));
      return sorted[middle];
    }
    std::array<float, 8> x;
    for (std::size_t i = 0; i < 8; ++i) x[i] = i < size_ ? values_[i] : std::numeric_limits<float>::infinity();
    const auto order = [&](std::size_t i, std::size_t k) {
      const float low = std::min(x[i], x[k]), high = std::max(x[i], x[k]);
      x[i] = low, x[k] = high;
    };
    order(0, 2), order(1, 3), order(4, 6), order(5, 7);
    order(0, 4), order(1, 5), order(2, 6), order(3, 7);
    order(0, 1), order(2, 3), order(4, 5), order(6, 7);
    order(2, 4), order(3, 5);
    order(1, 4), order(3, 6);
    order(1, 2), order(3, 4), order(5, 6);
    return x[middle];
  }

 private:
  std::array<float, 24> values_{};
  std::size_t size_ = 0;
};

/// Small for the triangles between two scan lines.
float elongation(const TriangleShape& s) {
  return s.circumradius > 0 ? s.shortest / s.circumradius : 1;
}
constexpr float elongated = 0.3f;

}  // namespace

MeshStars::MeshStars(std::span<const Triangle> triangles, std::size_t vertices)
    : start(vertices + 1, 0), items(3 * triangles.size()) {
  for (const Triangle& t : triangles)
    for (std::uint32_t v : t) ++start[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) start[v + 1] += start[v];
  // Filled by moving each start to its end; what was the end of one is the start of the next.
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t v : triangles[t]) items[start[v]++] = t;
  for (std::size_t v = vertices; v > 0; --v) start[v] = start[v - 1];
  start[0] = 0;
}

MeshSpacing::MeshSpacing(const PointMesh& mesh, std::span<const Vec3> places)
    : mesh_(mesh), shapes_(mesh.triangles.size()), stars_({}, 0) {
  tbb::parallel_invoke([&] { stars_ = MeshStars(mesh.triangles, places.size()); },
                       [&] {
                         tbb::parallel_for(std::size_t{0}, shapes_.size(), [&](std::size_t t) {
                           const Triangle& q = mesh.triangles[t];
                           shapes_[t] = shape_of(places[q[0]], places[q[1]], places[q[2]]);
                         });
                       });
  own_.resize(places.size());
  ratio_.assign(places.size(), 1);
  lowest_.resize(places.size());
  around_.assign(places.size(), -1);
  // Between scan lines the circle through three points spans the distance of the lines; on scattered points it is
  // smaller than the spacing, by 0.6 in the median of a Poisson process.
  constexpr float scattered = 1.5f, lines = 2.0f;
  const tbb::blocked_range<std::uint32_t> all(0, static_cast<std::uint32_t>(places.size()), 4096);
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::uint32_t v = range.begin(); v < range.end(); ++v) {
      Few radii, ratios;
      for (std::uint32_t t : stars_.of(v)) {
        const TriangleShape& s = shapes_[t];
        radii.add(s.circumradius);
        ratios.add(elongation(s));
      }
      if (radii.empty()) continue;
      ratio_[v] = ratios.lower_median();
      own_[v] = radii.lower_median() * (ratio_[v] < elongated ? lines : scattered);
    }
  });
  std::vector<float> smooth(places.size(), 0);
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::uint32_t v = range.begin(); v < range.end(); ++v) {
      Few around;
      for (std::uint32_t t : stars_.of(v)) {
        const Triangle& q = mesh.triangles[t];
        around.add(own_[q[0] == v ? q[1] : q[1] == v ? q[2] : q[0]]);
      }
      if (!around.empty()) smooth[v] = around.lower_median();
    }
  });
  tbb::parallel_for(all, [&](const auto& range) {
    for (std::uint32_t v = range.begin(); v < range.end(); ++v) {
      float least = smooth[v];
      for (std::uint32_t t : stars_.of(v)) {
        const Triangle& q = mesh.triangles[t];
        least = std::min({least, smooth[q[0]], smooth[q[1]], smooth[q[2]]});
      }
      lowest_[v] = least;
    }
  });
}

float MeshSpacing::lowest(const Triangle& t) const {
  return std::min({lowest_[t[0]], lowest_[t[1]], lowest_[t[2]]});
}

float MeshSpacing::at(std::uint32_t v) const {
  constexpr std::size_t enough = 40;
  constexpr float most_along = 10;
  const std::atomic_ref<float> kept(around_[v]);
  if (const float known = kept.load(std::memory_order_relaxed); known >= 0) return known;
  auto& [queue, seen, values, round] = scratch_.local();
  seen.resize(own_.size(), 0);
  ++round;
  queue.assign(1, v);
  seen[v] = round;
  std::size_t next = 0;
  const auto reach = [&, &queue = queue, &seen = seen, &round = round](std::size_t count) {
    for (; next < queue.size() && queue.size() < count; ++next)
      for (std::uint32_t t : stars_.of(queue[next]))
        for (std::uint32_t w : mesh_.triangles[t])
          if (seen[w] != round) seen[w] = round, queue.push_back(w);
  };
  const auto quantile = [&, &queue = queue, &values = values](auto&& value, std::size_t parts) {
    values.clear();
    for (std::uint32_t w : queue) values.push_back(value(w));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / parts);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  reach(enough);
  // On scan lines forty vertices are a stretch of very few lines, and where lines end or crowd none of them may be as
  // far apart as lines are: as many more are taken as points lie closer along a line.
  if (const float ratio = quantile([&](std::uint32_t w) { return ratio_[w]; }, 4); ratio < elongated)
    reach(static_cast<std::size_t>(std::min(most_along, 2 / std::max(ratio, 0.01f)) * enough));
  const float result = stars_.of(v).empty() ? 0 : quantile([&](std::uint32_t w) { return own_[w]; }, 2);
  kept.store(result, std::memory_order_relaxed);
  return result;
}

float MeshSpacing::at(const Triangle& t) const {
  return std::max({at(t[0]), at(t[1]), at(t[2])});
}

}  // namespace tri
