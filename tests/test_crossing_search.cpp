#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "libtri/surfaces/crossing_search.hpp"
#include "meshops/crossings/self_intersections.hpp"

using namespace tri;

namespace {

constexpr std::size_t n_points = 120, n_triangles = 200;

struct Tangle {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::mt19937 random{5};

  Tangle() {
    std::uniform_real_distribution<double> at(0, 1);
    for (std::size_t i = 0; i < n_points; ++i) points.emplace_back(at(random), at(random), at(random));
    for (std::size_t i = 0; i < n_triangles; ++i) triangles.push_back(any());
  }
  Triangle any() {
    Triangle t{0, 0, 0};
    while (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      for (auto& v : t) v = static_cast<std::uint32_t>(random() % n_points);
    return t;
  }
  long crossed_by(const Triangle& q, const std::vector<std::uint32_t>& ids,
                  const std::vector<std::int32_t>& skip) const {
    long count = 0;
    for (const std::uint32_t i : ids) {
      const Triangle& r = triangles[i];
      const bool shared = std::find_first_of(q.begin(), q.end(), r.begin(), r.end()) != q.end();
      if (shared || std::count(skip.begin(), skip.end(), static_cast<std::int32_t>(i))) continue;
      count +=
          triangles_intersect({points[q[0]], points[q[1]], points[q[2]]}, {points[r[0]], points[r[1]], points[r[2]]});
    }
    return count;
  }
};

}  // namespace

TEST_CASE("CrossingSearch: counts what each triangle against each other finds, also after changes") {
  Tangle tangle;
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = 0; i < n_triangles; ++i)
    if (i % 5 != 2) ids.push_back(i);
  CrossingSearch search(tangle.points, tangle.triangles, ids);
  long found = 0;
  for (int round = 0; round < 60; ++round) {
    const Triangle q = tangle.any();
    const std::vector<std::int32_t> skip{round, round + 7};
    const long count = search.count(q, skip);
    CHECK(count == tangle.crossed_by(q, ids, skip));
    found += count;
    const std::uint32_t changed = ids[tangle.random() % ids.size()];
    tangle.triangles[changed] = tangle.any();
    search.note_change(changed);
    if (round % 16 == 15) {
      search.refresh();
      CHECK(search.changes() == 0);
    }
  }
  CHECK(found > 100);
}
