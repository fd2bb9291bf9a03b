#include "meshops/points/thin_for_display.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "meshops/error.hpp"
#include "meshops/limits.hpp"

namespace tri {
namespace {

Soup points_alone(const Soup& soup, const std::vector<std::uint32_t>& chosen) {
  Soup result;
  result.points.reserve(chosen.size());
  for (const std::uint32_t v : chosen) result.points.push_back(soup.points[v]);
  if (!soup.vertex_colors.empty())
    for (const std::uint32_t v : chosen) result.vertex_colors.push_back(soup.vertex_colors[v]);
  if (!soup.vertex_normals.empty())
    for (const std::uint32_t v : chosen) result.vertex_normals.push_back(soup.vertex_normals[v]);
  for (const auto& [name, values] : soup.vertex_scalars) {
    std::vector<double>& kept = result.vertex_scalars[name];
    kept.reserve(chosen.size());
    for (const std::uint32_t v : chosen) kept.push_back(values[v]);
  }
  return result;
}

// For every vertex the one that stands for its cell.
std::vector<std::uint32_t> representatives(const Soup& soup, const Vec3& low, double cell) {
  struct Entry {
    std::uint64_t key;
    std::uint32_t vertex;
  };
  std::vector<Entry> entries(soup.points.size());
  for (std::uint32_t v = 0; v < entries.size(); ++v) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k)
      key = key << 21 |
            std::min<std::uint64_t>(static_cast<std::uint64_t>((soup.points[v][k] - low[k]) / cell), (1u << 21) - 1);
    entries[v] = {key, v};
  }
  tbb::parallel_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : a.vertex < b.vertex;
  });
  std::vector<std::uint32_t> result(soup.points.size());
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    Vec3 mean(0, 0, 0);
    for (end = begin; end < entries.size() && entries[end].key == entries[begin].key; ++end)
      mean += soup.points[entries[end].vertex];
    mean /= static_cast<double>(end - begin);
    std::uint32_t nearest = entries[begin].vertex;
    for (std::size_t i = begin; i < end; ++i)
      if ((soup.points[entries[i].vertex] - mean).sqrnorm() < (soup.points[nearest] - mean).sqrnorm())
        nearest = entries[i].vertex;
    for (std::size_t i = begin; i < end; ++i) result[entries[i].vertex] = nearest;
  }
  return result;
}

std::vector<Triangle> gathered(const Soup& soup, const std::vector<std::uint32_t>& stands_for) {
  std::vector<Triangle> triangles;
  for (const Triangle& t : soup.triangles) {
    Triangle g{stands_for[t[0]], stands_for[t[1]], stands_for[t[2]]};
    if (g[0] == g[1] || g[1] == g[2] || g[2] == g[0]) continue;
    std::rotate(g.begin(), std::min_element(g.begin(), g.end()), g.end());
    triangles.push_back(g);
  }
  tbb::parallel_sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

Soup thinned_points(const Soup& soup, std::size_t most) {
  std::vector<std::uint32_t> chosen(most);
  for (std::size_t i = 0; i < most; ++i)
    chosen[i] = static_cast<std::uint32_t>(static_cast<std::uint64_t>(i) * soup.points.size() / most);
  return points_alone(soup, chosen);
}

Soup thinned_triangles(const Soup& soup, std::size_t most) {
  Vec3 low(std::numeric_limits<double>::infinity()), high = -low;
  double area = 0;
  for (const Triangle& t : soup.triangles) {
    const Vec3& a = soup.points[t[0]];
    area += 0.5 * ((soup.points[t[1]] - a) % (soup.points[t[2]] - a)).norm();
  }
  for (const Vec3& p : soup.points) {
    low.minimize(p);
    high.maximize(p);
  }
  // A surface crosses about one and a half cells where it covers the side of one, and each makes two triangles.
  const double diagonal = (high - low).norm();
  double cell = std::max(std::sqrt(3 * area / static_cast<double>(most)), diagonal * 1e-6);
  if (!(cell > 0)) cell = 1;  // all in one place
  std::vector<std::uint32_t> stands_for;
  std::vector<Triangle> triangles;
  for (;; cell *= 1.2) {
    stands_for = representatives(soup, low, cell);
    triangles = gathered(soup, stands_for);
    if (triangles.size() <= most) break;
  }
  std::vector<std::uint32_t> place(soup.points.size(), no_index), chosen;
  for (Triangle& t : triangles)
    for (std::uint32_t& v : t) {
      if (place[v] == no_index) {
        place[v] = static_cast<std::uint32_t>(chosen.size());
        chosen.push_back(v);
      }
      v = place[v];
    }
  Soup result = points_alone(soup, chosen);
  result.triangles = std::move(triangles);
  return result;
}

}  // namespace

Soup thin_for_display(const Soup& soup, std::size_t most) {
  if (most == 0) throw InvalidInput("nothing would be left to display");
  if (soup.triangles.empty()) return soup.points.size() <= most ? soup : thinned_points(soup, most);
  return soup.triangles.size() <= most ? soup : thinned_triangles(soup, most);
}

}  // namespace tri
