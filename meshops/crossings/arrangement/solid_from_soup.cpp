#include "meshops/crossings/arrangement/solid_from_soup.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "meshops/crossings/triangle_pieces.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/search/closest_triangle.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr double first_reach_share = 0x1p-20;  ///< of the extent: within it things are taken to touch if they cross again
constexpr double nudge_in_reaches = 8, nudge_share = 0.05;  ///< the smaller one, the second of the deviation that is allowed
constexpr double plate_share = 0.02;  ///< half the thickness of plates and gaps, of the deviation that is allowed

std::vector<Vec3> used_points(const Soup& soup) {
  std::vector<char> used(soup.points.size());
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) used[v] = 1;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) points.push_back(soup.points[i]);
  return points;
}

double diagonal(const std::vector<GridPoint>& points) {
  if (points.empty()) return 0;
  GridPoint low = points[0], high = points[0];
  for (const GridPoint& p : points)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  return std::hypot(static_cast<double>(high[0] - low[0]), static_cast<double>(high[1] - low[1]),
                    static_cast<double>(high[2] - low[2]));
}

/// Whether a triangle is nowhere farther than `reach` from others: its pieces are within it of one triangle each, as distance
/// from a triangle is largest in a corner.
bool lies_within(const std::array<Vec3, 3>& triangle, const ClosestTriangle& nearest, double reach) {
  constexpr std::size_t most_pieces = 200;
  std::vector<std::array<Vec3, 3>> pieces{triangle};
  std::uint32_t hint = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const auto [a, b, c] = pieces[i];
    const Vec3 middle = (a + b + c) / 3.0;
    const ClosestTriangle::Hit hit = nearest.closest(middle, hint);
    hint = hit.triangle;
    if (hit.distance > reach) return false;
    const double radius = std::sqrt(std::max({(a - middle).sqrnorm(), (b - middle).sqrnorm(), (c - middle).sqrnorm()}));
    if (hit.distance + radius <= reach) continue;
    const std::array<Vec3, 3>& near = nearest.corners(hit.triangle);
    const auto within = [&](const Vec3& p) { return (closest_on_triangle(near, p) - p).norm() <= reach; };
    if (within(a) && within(b) && within(c)) continue;
    if (pieces.size() + 4 > most_pieces) return false;
    const Vec3 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
    pieces.insert(pieces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return true;
}

/// Moves all points of each part, or each point, in a direction of its own, by up to `farthest` grid steps.
void nudge(CrossingComplex& complex, double farthest, bool each) {
  DisjointSets parts(complex.points.size());
  if (!each)
    for (const CrossingComplex::Face& f : complex.faces) parts.join(f.v[0], f.v[1]), parts.join(f.v[1], f.v[2]);
  std::set<GridPoint> taken(complex.points.begin(), complex.points.end());
  for (std::size_t i = 0; i < complex.points.size(); ++i) {
    RandomStream random(parts.find(i) + 1);
    GridPoint p = complex.points[i];
    for (std::int64_t& x : p) x += static_cast<std::int64_t>((2 * random.uniform() - 1) * farthest);
    if (taken.insert(p).second) complex.points[i] = p;
  }
}

}  // namespace

SolidFromSoup::SolidFromSoup(Soup& soup, double max_deviation, bool keep_walls, int finest)
    : soup_(soup), max_deviation_(max_deviation), keep_walls_(keep_walls), frame_(used_points(soup), finest) {}

void SolidFromSoup::take_triangles(Report& report) {
  std::map<GridPoint, std::uint32_t> numbers;
  std::vector<std::uint32_t> number(soup_.points.size(), none);
  std::vector<Triangle> taken;
  std::map<Triangle, std::uint32_t> seen;
  double flat = 0, duplicates = 0;
  for (std::uint32_t i = 0; i < soup_.triangles.size(); ++i) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = soup_.triangles[i][k];
      if (number[v] == none) {
        const auto [it, added] =
            numbers.emplace(frame_.to_grid(soup_.points[v]), static_cast<std::uint32_t>(complex_.points.size()));
        if (added) {
          complex_.points.push_back(it->first);
          vertex_of_point_.push_back(v);
        }
        number[v] = it->second;
      }
      t[k] = number[v];
    }
    Triangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (repeats_vertex(t)) ++flat;
    else if (!seen.emplace(sorted, i).second) ++duplicates;
    else {
      taken.push_back(t);
      triangle_of_given_.push_back(i);
    }
  }
  if (flat > 0) report.figures["triangles without extent dropped"] = flat;
  if (duplicates > 0) report.figures["duplicates dropped"] = duplicates;
  closed_.triangles = std::move(taken);
}

SurfaceContacts SolidFromSoup::run(Report& report, bool tell_progress, Context& context) {
  const auto done = [&](double share) {
    if (tell_progress) context.progress("make-solid", share);
  };
  take_triangles(report);
  if (closed_.triangles.empty()) {
    report.figures.clear();  // nothing with an extent to make a solid of: it stays
    return surface_contacts(soup_.points, soup_.triangles, context);
  }
  std::vector<Vec3> places;
  for (const GridPoint& p : complex_.points) places.push_back(frame_.to_space(p));
  const std::vector<Triangle> given = std::move(closed_.triangles);
  closed_ = close_surface(places, given, context);
  done(0.1);
  for (std::uint32_t t = 0; t < closed_.triangles.size(); ++t)
    complex_.faces.push_back({closed_.triangles[t], t, 1, t < closed_.given});
  const CrossingReport crossings = cut_along_crossings(report, context);
  done(0.6);
  const CellLabels labels = label_cells(complex_, closed_.cavity, context);
  report.faces_reversed = closed_.reversed;
  if (closed_.holes > 0) report.figures["holes closed"] = static_cast<double>(closed_.holes);
  if (closed_.inside_out > 0) report.figures["components turned outward"] = static_cast<double>(closed_.inside_out);
  if (crossings.pairs > 0) {
    report.figures["crossing pairs"] = static_cast<double>(crossings.pairs);
    report.figures["rounds of cutting"] = static_cast<double>(crossings.rounds);
    report.figures["faces cut"] = static_cast<double>(crossings.cut);
  }
  const PlacedBoundary boundary = boundary_without_contacts(labels, report, context);
  done(0.9);
  if (boundary.triangles.empty()) {
    report = Report{.operation = report.operation};  // nothing encloses anything: it stays
    return surface_contacts(soup_.points, soup_.triangles, context);
  }
  SurfaceContacts contacts;
  const std::vector<Vec3> result = places_of(boundary, labels, contacts, context);
  write(boundary, result, report);
  return contacts;
}

/// Faces that lie nearly upon each other can make rounding and cutting go on for ever: then parts are first moved a little
/// against each other, and if that is not enough every point.
CrossingReport SolidFromSoup::cut_along_crossings(Report& report, Context& context) {
  const CrossingComplex given = complex_;
  const double reach = frame_.steps_in(first_reach_share);
  CrossingReport best = resolve_crossings(complex_, reach, context);
  const double farthest = std::min(nudge_in_reaches * reach, nudge_share * max_deviation_ * diagonal(given.points));
  for (const bool each : {false, true}) {
    if (best.left == 0 || farthest < reach) break;
    CrossingComplex nudged = given;
    nudge(nudged, farthest, each);
    const CrossingReport now = resolve_crossings(nudged, reach, context);
    if (now.left >= best.left) continue;
    best = now;
    complex_ = std::move(nudged);
    report.figures["points nudged by, at most"] = farthest * frame_.step();
  }
  return best;
}

/// Walls inside the solid go where they are near to what stays; sheets outside only if the whole of one is.
std::vector<char> SolidFromSoup::walls_to_keep(const CellLabels& labels, Context& context) const {
  const std::size_t n = complex_.faces.size();
  std::vector<char> keep(n, 0);
  std::vector<std::uint32_t> walls;
  std::vector<Triangle> stays;
  for (std::uint32_t f = 0; f < n; ++f) {
    if (labels.inside[f][0] != labels.inside[f][1]) stays.push_back(complex_.faces[f].v);
    else if (complex_.faces[f].original) walls.push_back(f);
  }
  if (!keep_walls_ || walls.empty()) return keep;
  if (stays.empty()) {
    for (const std::uint32_t f : walls) keep[f] = 1;
    return keep;
  }
  std::vector<Vec3> places;
  for (const GridPoint& p : complex_.points)
    places.emplace_back(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  const double reach = max_deviation_ * diagonal(complex_.points);
  const ClosestTriangle nearest(places, stays);
  std::vector<char> far(walls.size(), 0);
  DisjointSets sheets(walls.size());
  std::unordered_map<std::uint64_t, std::uint32_t> at_edge;
  for (std::uint32_t i = 0; i < walls.size(); ++i) {
    if (i % 1024 == 0) context.checkpoint();
    const Triangle& v = complex_.faces[walls[i]].v;
    far[i] = !lies_within({places[v[0]], places[v[1]], places[v[2]]}, nearest, reach);
    if (labels.inside[walls[i]][0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = v[k], q = v[(k + 1) % 3];
      const auto [it, added] = at_edge.emplace(static_cast<std::uint64_t>(std::min(p, q)) << 32 | std::max(p, q), i);
      if (!added) sheets.join(it->second, i);
    }
  }
  std::vector<char> sheet_far(walls.size(), 0);
  for (std::uint32_t i = 0; i < walls.size(); ++i)
    if (far[i]) sheet_far[sheets.find(i)] = 1;
  for (std::uint32_t i = 0; i < walls.size(); ++i) keep[walls[i]] = sheet_far[sheets.find(i)];
  return keep;
}

/// Sheets that cannot be parted go, so that nothing touches.
PlacedBoundary SolidFromSoup::boundary_without_contacts(const CellLabels& labels, Report& report, Context& context) {
  SolidBoundaryOptions options{walls_to_keep(labels, context)};
  const double height = std::max(1.0, plate_share * max_deviation_ * diagonal(complex_.points));
  constexpr int tries = 6;
  std::size_t contacts = 0;
  SheetMemory memory;
  for (int i = 0;; ++i) {
    if (i == tries) std::fill(options.keep_walls.begin(), options.keep_walls.end(), 0);
    const SolidBoundary boundary = solid_boundary(complex_, labels, options, context);
    PlacedBoundary placed = part_sheets(complex_, boundary, height, memory, context);
    if (!placed.touching.empty() && i < tries) {
      contacts += placed.touching.size();
      for (const std::uint32_t f : placed.touching) options.keep_walls[f] = 0;
      continue;
    }
    if (boundary.dropped_walls > 0) report.figures["faces inside dropped"] = static_cast<double>(boundary.dropped_walls);
    if (boundary.doubled > 0) report.figures["faces kept as thin walls"] = static_cast<double>(boundary.doubled);
    if (contacts > 0) report.figures["walls dropped because their sides would touch"] = static_cast<double>(contacts);
    return placed;
  }
}

/// Parts in which nothing was cut or parted keep their coordinates, unless that makes something cross.
std::vector<Vec3> SolidFromSoup::places_of(const PlacedBoundary& boundary, const CellLabels& labels,
                                           SurfaceContacts& contacts, Context& context) const {
  std::vector<char> touched(complex_.faces.size(), 0);  // of parts
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    const std::uint32_t face = boundary.face[t];
    Triangle now;
    for (std::size_t k = 0; k < 3; ++k) now[k] = boundary.point[boundary.triangles[t][k]];
    Triangle was = closed_.triangles[complex_.faces[face].source];
    std::sort(now.begin(), now.end());
    std::sort(was.begin(), was.end());
    if (now != was) touched[labels.part[face]] = 1;
  }
  std::vector<Vec3> places;
  for (const GridPoint& p : boundary.points) places.push_back(frame_.to_space(p));
  std::vector<Vec3> restored = places;
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    if (touched[labels.part[boundary.face[t]]]) continue;
    for (const std::uint32_t v : boundary.triangles[t])
      if (boundary.point[v] < vertex_of_point_.size() && !boundary.moved[v]) restored[v] = soup_.points[vertex_of_point_[boundary.point[v]]];
  }
  contacts = surface_contacts(restored, boundary.triangles, context);
  if (contacts.none() || restored == places) return restored;
  contacts = surface_contacts(places, boundary.triangles, context);
  return places;
}

void SolidFromSoup::write(const PlacedBoundary& boundary, const std::vector<Vec3>& places, Report& report) {
  TrianglePieces pieces;
  pieces.places = places;
  for (const std::uint32_t point : boundary.point)
    pieces.original.push_back(point < vertex_of_point_.size() ? vertex_of_point_[point] : none);
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    const std::uint32_t piece_of = complex_.faces[boundary.face[t]].source;
    Triangle within = closed_.triangles[piece_of];
    for (std::uint32_t& c : within) c = vertex_of_point_[c];
    pieces.triangles.push_back({boundary.triangles[t], within, triangle_of_given_[closed_.source[piece_of]]});
  }
  replace_by_pieces(soup_, pieces, report);
}

}  // namespace tri
