#include "libtri/triangulation/coverage.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include "libtri/quiet_context.hpp"
#include "libtri/triangulation/empty_discs.hpp"
#include "libtri/triangulation/mesh_spacing.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/search/nearest_points.hpp"
#include "meshops/select_indices.hpp"

namespace tri {
namespace {

/// A place on the model and how far it is to the nearest point or free edge.
struct Disc {
  Vec3 center{0, 0, 0};
  std::array<float, 3> normal{};
  double radius = 0, spacing = 0;
  std::uint32_t triangle = 0;
  std::int32_t face = -1;
};

bool same_side(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return cosine(a, b) > 0.3;
}

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
  QuietContext quiet(context, context.threads);
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
    const std::vector<Foot> met = registration.register_points(ahead, quiet);
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

/// Only a triangle with a large circumcircle can hold the middle of a large empty disc. @return those, ascending
std::vector<std::uint32_t> wide_triangles(const PointMesh& mesh, const MeshSpacing& spacing, double hole_size) {
  return select_indices(mesh.triangles.size(), [&](std::uint32_t t) {
    const double radius = spacing.shape(t).circumradius;
    return radius >= 0.9 * hole_size * spacing.lowest(mesh.triangles[t]) &&
           radius >= 0.9 * hole_size * spacing.at(mesh.triangles[t]);
  });
}

/// Spreads probes over a triangle, but not close to a point where the triangle lies along its side of the part: no disc
/// that matters is empty there.
/// @param h  spacing of the points around
void add_probes(const PointMesh& mesh, std::span<const Foot> feet, std::span<const Vec3> places, std::uint32_t t,
                double h, double hole_size, double longest, std::vector<Vec3>& probes,
                std::vector<std::uint32_t>& probe_triangle) {
  const Triangle& q = mesh.triangles[t];
  const Vec3 &a = places[q[0]], &b = places[q[1]], &c = places[q[2]];
  const auto normal = facing(q, places);
  const auto along = [&](std::uint32_t v) { return cosine(feet[v].normal, normal) > 0.9; };
  std::array<Vec3, 6> points;
  std::size_t n_points = 0;
  if (along(q[0]) && along(q[1]) && along(q[2])) {
    for (const std::uint32_t v : q) points[n_points++] = places[v];
    for (const std::int32_t other : mesh.neighbors[t]) {
      if (other < 0) continue;
      for (const std::uint32_t v : mesh.triangles[static_cast<std::size_t>(other)])
        if (v != q[0] && v != q[1] && v != q[2] && along(v)) points[n_points++] = places[v];
    }
  }
  const double close = 0.45 * hole_size * h;
  const int n = std::clamp(static_cast<int>(std::ceil(longest / std::max(h, 1e-300))), 3, 12);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Vec3 probe = (a * i + b * j + c * (n - i - j)) / n;
      if (std::any_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n_points),
                      [&](const Vec3& p) { return (p - probe).sqrnorm() < close * close; }))
        continue;
      probes.push_back(probe);
      probe_triangle.push_back(t);
    }
}

/// Closes triangles again until the open ones leave no vertex without a triangle and no vertex with two fans.
void keep_manifold(const PointMesh& mesh, const MeshStars& stars, std::vector<bool>& open,
                   const std::vector<float>& size) {
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
  const MeshSpacing spacing(mesh, places);
  std::vector<float> result;
  for (std::uint32_t v = 0; v < places.size(); ++v) result.push_back(spacing.at(v));
  return result;
}

Coverage find_unmeasured(const CadModel& model, const Registration& registration, const PointMesh& mesh,
                         std::span<const Foot> feet, double hole_size, Context& context) {
  Coverage result;
  if (mesh.triangles.empty()) return result;
  context.checkpoint();
  QuietContext quiet(context, context.threads);
  std::vector<Vec3> places(feet.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, feet.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) places[i] = feet[i].point;
  });
  const MeshSpacing spacing(mesh, places);
  context.checkpoint();

  std::vector<Vec3> probes;
  std::vector<std::uint32_t> probe_triangle;
  for (const std::uint32_t t : wide_triangles(mesh, spacing, hole_size))
    add_probes(mesh, feet, places, t, spacing.at(mesh.triangles[t]), hole_size, spacing.shape(t).longest, probes,
               probe_triangle);
  context.checkpoint();
  if (probes.empty()) return result;
  std::vector<Foot> probe_feet = registration.register_points(probes, quiet);
  double finest = infinity, widest_spacing = 0;
  for (std::uint32_t t : probe_triangle) {
    const double h = spacing.at(mesh.triangles[t]);
    if (h > 0) finest = std::min(finest, h);
    widest_spacing = std::max(widest_spacing, h);
  }
  const bool sides_missing = send_through(mesh, places, model.diagonal, finest < infinity ? finest : 0, probes,
                                          probe_triangle, registration, probe_feet, context);
  context.checkpoint();
  EmptyDiscs empty(model, feet, probe_feet, 4 * hole_size * widest_spacing,
                   std::max(0.25 * finest, 0.01 * widest_spacing), context);
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
  const std::vector<EmptyDiscs::End> ends = empty.ends(probe_feet, context);
  for (std::uint32_t i = 0; i < probes.size(); ++i) {
    if (probe_feet[i].face < 0) continue;
    const Growing g{i, ends[i]};
    if (!keep_empty(g) && g.end.distance > 0.5 * hole_size * spacing_of(g)) growing.push_back(g);
  }
  // Around a corner of the part triangles cut short, and their probes miss the middle of the gap: discs are pushed away
  // from what ends them as long as they grow.
  for (int round = 0; round < 6 && !growing.empty(); ++round) {
    std::vector<Vec3> pushed;
    for (const Growing& g : growing)
      pushed.push_back(probe_feet[g.probe].point + (probe_feet[g.probe].point - g.end.place) * 0.3);
    const std::vector<Foot> pushed_feet = registration.register_points(pushed, quiet);
    const std::vector<EmptyDiscs::End> pushed_ends = empty.ends(pushed_feet, context);
    std::vector<Growing> still;
    for (std::size_t k = 0; k < growing.size(); ++k) {
      if (pushed_feet[k].face < 0) continue;
      const Growing g{growing[k].probe, pushed_ends[k]};
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
  std::vector<bool> small_middle;  // such triangles are open only if they stand for another side than the one they lie
                                   // on
  std::vector<NearestPoints::Neighbor> near;
  Pace pace(context);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    pace();
    const Triangle& q = mesh.triangles[t];
    if (open[t]) continue;
    const bool small = spacing.shape(t).longest < spacing.lowest(q) || spacing.shape(t).longest < spacing.at(q);
    if (small && !sides_missing) continue;
    const Vec3 middle = (places[q[0]] + places[q[1]] + places[q[2]]) / 3;
    center_tree.nearest(middle, 1, near);
    if (near[0].squared_distance > widest * widest) continue;
    middles.push_back(middle);
    middle_triangle.push_back(t);
    small_middle.push_back(small);
  }
  const std::vector<Foot> middle_feet = registration.register_points(middles, quiet);
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
  context.checkpoint();
  std::vector<float> size(mesh.triangles.size(), 0);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (open[t]) size[t] = spacing.shape(t).circumradius;
  keep_manifold(mesh, spacing.stars(), open, size);

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
