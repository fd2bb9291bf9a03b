#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "wavy_torus.hpp"

namespace tri {

/// A wavy torus of 2 n^2 triangles with 400 holes of 8 triangles and eight gaps of one cell across the whole tube.
inline Soup torus_with_holes(std::uint32_t n) {
  Soup soup = wavy_torus(n, n, 0.02);
  std::vector<char> gone(soup.triangles.size(), 0);
  const auto cell = [&](std::uint32_t i, std::uint32_t k) {
    for (const std::uint32_t half : {0u, 1u}) gone[2 * (i % n * n + k % n) + half] = 1;
  };
  for (std::uint32_t h = 0; h < 400; ++h)
    for (const std::uint32_t di : {0u, 1u})
      for (const std::uint32_t dk : {0u, 1u}) cell(h * 7919 % n + di, h * 104729 % n + dk);
  for (std::uint32_t gap = 0; gap < 8; ++gap)
    for (std::uint32_t k = 0; k < n; ++k) cell(gap * n / 8, k);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < gone.size(); ++t)
    if (!gone[t]) soup.triangles[kept++] = soup.triangles[t];
  soup.triangles.resize(kept);
  return soup;
}

/// A wavy torus of about 2 n^2 triangles with everything that repair is for: holes, triangles twice (every other time
/// turned around), reversed ones, points of their own, T-junctions, needles and caps, fins, crossings, and small solids
/// apart from it.
inline Soup damaged_torus(std::uint32_t n) {
  Soup soup = torus_with_holes(n);
  const std::size_t count = soup.triangles.size();
  const auto point = [&](Vec3 p) {
    soup.points.push_back(p);
    return static_cast<std::uint32_t>(soup.points.size() - 1);
  };
  for (std::size_t t = 0; t < count; t += 20) {
    Triangle& tri = soup.triangles[t];
    switch (t / 20 % 10) {
      case 0: {
        Triangle twin = tri;
        if (t / 200 % 2) std::swap(twin[0], twin[1]);
        soup.triangles.push_back(twin);
        break;
      }
      case 1:
      case 2:
        std::swap(tri[0], tri[1]);
        break;
      case 3:
      case 4:
      case 5:  // points of its own, at the same places
        for (std::uint32_t& v : tri) v = point(Vec3(soup.points[v]));
        break;
      case 6: {  // one side has a vertex that its neighbour does not have
        const std::uint32_t m = point((soup.points[tri[0]] + soup.points[tri[1]]) / 2.0);
        const Triangle rest = {m, tri[1], tri[2]};
        tri[1] = m;
        soup.triangles.push_back(rest);
        break;
      }
      case 7: {  // a cap on a side
        const std::uint32_t m = point((soup.points[tri[0]] + soup.points[tri[1]]) / 2.0);
        const Triangle cap = {tri[0], tri[1], m}, rest = {m, tri[1], tri[2]};
        tri[1] = m;
        soup.triangles.push_back(rest);
        soup.triangles.push_back(cap);
        break;
      }
      case 8: {  // a fin
        const std::uint32_t m = point(soup.points[tri[2]] * 1.02);
        const Triangle fin = {tri[0], tri[1], m};
        soup.triangles.push_back(fin);
        break;
      }
      case 9:  // a vertex pulled through its neighbours, less often
        if (t / 200 % 8 == 0) soup.points[tri[0]] *= 0.99;
        break;
    }
  }
  for (std::uint32_t s = 0; s < n; ++s) {  // tetrahedra, some through the surface
    const Vec3 at = soup.points[s * std::size_t{n} + s] * 1.03;
    const std::uint32_t a = point(at), b = point(at + Vec3(0.3, 0, 0)), c = point(at + Vec3(0, 0.3, 0)),
                        d = point(at + Vec3(0, 0, 0.3));
    for (const Triangle& side : {Triangle{a, c, b}, Triangle{a, b, d}, Triangle{b, c, d}, Triangle{c, a, d}})
      soup.triangles.push_back(side);
  }
  return soup;
}

}  // namespace tri
