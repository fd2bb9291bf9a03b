#include "meshops/crossings/arrangement/solid_from_soup.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "meshops/checks/surface_reach.hpp"
#include "meshops/crossings/arrangement/cut_tips.hpp"
#include "meshops/crossings/arrangement/grid_hash.hpp"
#include "meshops/crossings/arrangement/settle_moves.hpp"
#include "meshops/crossings/triangle_pieces.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/closest_triangle.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/search/number_map.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr double first_reach_share = 0x1p-20;  ///< of the extent: within it things are taken to touch if they cross
                                               ///< again
constexpr double nudge_in_reaches = 8,
                 nudge_share = 0.05;  ///< the smaller one, the second of the deviation that is allowed
constexpr double reach_share = 0.5;   ///< the same of how far things may be apart that are taken to touch
constexpr double wall_share = 0.95;   ///< the same of what a wall that goes may be away from what stays, which may move
                                      ///< itself
constexpr double plate_share = 0.02;  ///< half the thickness of plates and gaps, of the deviation that is allowed

double grid_diagonal(const std::vector<GridPoint>& points) {
  if (points.empty()) return 0;
  GridPoint low = points[0], high = points[0];
  for (const GridPoint& p : points)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  return std::hypot(static_cast<double>(high[0] - low[0]), static_cast<double>(high[1] - low[1]),
                    static_cast<double>(high[2] - low[2]));
}

ReachOfTriangle::Verdict judge_reach(const std::array<Vec3, 3>& triangle, const ClosestTriangle& nearest,
                                     double reach) {
  constexpr std::size_t most_pieces = 200;
  std::uint32_t hint = 0;
  return reach_of(triangle, nearest, reach, most_pieces, hint).verdict;
}

struct TriangleHash {
  std::size_t operator()(const Triangle& t) const {
    std::uint64_t h = 0;
    for (const std::uint32_t v : t) h = (h ^ v) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    return static_cast<std::size_t>(h);
  }
};

/// Moves all points of each part, or each point, in a direction of its own, by up to `farthest` grid steps.
void nudge(CrossingComplex& complex, double farthest, bool each, const Context& context) {
  Pace pace(context);
  DisjointSets parts(complex.points.size());
  if (!each)
    for (const CrossingComplex::Face& f : complex.faces) parts.join(f.v[0], f.v[1]), parts.join(f.v[1], f.v[2]);
  NumberMap<GridPoint, GridHash> taken(2 * complex.points.size());
  for (const GridPoint& p : complex.points) pace(), taken.insert(p, 0);
  for (std::size_t i = 0; i < complex.points.size(); ++i) {
    pace();
    RandomStream random(parts.find(i) + 1);
    GridPoint p = complex.points[i];
    for (std::int64_t& x : p) x += static_cast<std::int64_t>((2 * random.uniform() - 1) * farthest);
    if (taken.insert(p, 0).second) complex.points[i] = p;
  }
}

}  // namespace

SolidFromSoup::SolidFromSoup(Soup& soup, double max_deviation, bool keep_walls, int finest, bool apart, bool again,
                             std::vector<std::uint32_t>& fillings)
    : soup_(soup), max_deviation_(max_deviation), keep_walls_(keep_walls), apart_(apart), again_(again),
      fillings_(fillings), frame_(soup, finest) {}

void SolidFromSoup::take_triangles(Report& report, const Context& context) {
  Pace pace(context);
  NumberMap<GridPoint, GridHash> numbers(soup_.points.size());
  std::vector<std::uint32_t> number(soup_.points.size(), no_index);
  std::vector<Triangle> taken;
  NumberMap<Triangle, TriangleHash> seen(soup_.triangles.size());
  double flat = 0, duplicates = 0;
  const auto filling = [&](std::uint32_t t) { return std::binary_search(fillings_.begin(), fillings_.end(), t); };
  for (std::uint32_t i = 0; i < soup_.triangles.size(); ++i) {
    pace();
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = soup_.triangles[i][k];
      if (number[v] == no_index) {
        const GridPoint place = frame_.to_grid(soup_.points[v]);
        const auto [same, added] = numbers.insert(place, static_cast<std::uint32_t>(complex_.points.size()));
        if (added) {
          complex_.points.push_back(place);
          vertex_of_point_.push_back(v);
        }
        number[v] = same;
      }
      t[k] = number[v];
    }
    Triangle sorted = t;
    std::sort(sorted.begin(), sorted.end());
    if (repeats_vertex(t))
      ++flat;
    else if (const auto [earlier, added] = seen.insert(sorted, i); !added) {
      ++duplicates;
      if (!filling(i)) std::erase(fillings_, earlier);
    } else {
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
  take_triangles(report, context);
  Pace pace(context);
  if (closed_.triangles.empty()) {
    report.figures.clear();  // nothing with an extent to make a solid of: it stays
    return surface_contacts(soup_.points, soup_.triangles, context);
  }
  std::vector<Vec3> places;
  for (const GridPoint& p : complex_.points) pace(), places.push_back(frame_.to_space(p));
  const std::vector<Triangle> given = std::move(closed_.triangles);
  closed_ = close_surface(places, given, context);
  done(0.1);
  for (std::uint32_t t = 0; t < closed_.triangles.size(); ++t, pace())
    complex_.faces.push_back(
        {closed_.triangles[t], t, 1,
         t < closed_.given && !std::binary_search(fillings_.begin(), fillings_.end(), triangle_of_given_[t])});
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
  write(boundary, result, report, context);
  return contacts;
}

/// Faces that lie nearly upon each other can make rounding and cutting go on for ever: then parts are first moved a
/// little against each other, and if that is not enough every point.
CrossingReport SolidFromSoup::cut_along_crossings(Report& report, Context& context) {
  const CrossingComplex given = complex_;
  const double reach = frame_.steps_in(first_reach_share);
  const double allowed = max_deviation_ * grid_diagonal(given.points),
               most_reach = (again_ ? plate_share / 2 : reach_share) * allowed;
  CrossingReport best = resolve_crossings(complex_, reach, most_reach, context);
  const double farthest = std::min(nudge_in_reaches * reach, nudge_share * allowed);
  for (const bool each : {false, true}) {
    if (best.left == 0 || farthest < reach) break;
    CrossingComplex nudged = given;
    nudge(nudged, farthest, each, context);
    const CrossingReport now = resolve_crossings(nudged, reach, most_reach, context);
    if (now.left >= best.left) continue;
    best = now;
    complex_ = std::move(nudged);
    report.figures["points nudged by, at most"] = farthest * frame_.step();
  }
  return best;
}

/// Walls inside the solid go where they are near to what stays; sheets outside only if the whole of one is.
std::vector<char> SolidFromSoup::walls_to_keep(const CellLabels& labels, Context& context) const {
  Pace pace(context);
  const std::size_t n = complex_.faces.size();
  std::vector<char> keep(n, 0);
  std::vector<std::uint32_t> walls;
  std::vector<Triangle> stays;
  for (std::uint32_t f = 0; f < n; ++f) {
    pace();
    if (labels.inside[f][0] != labels.inside[f][1])
      stays.push_back(complex_.faces[f].v);
    else if (complex_.faces[f].original)
      walls.push_back(f);
  }
  if (!keep_walls_ || walls.empty()) return keep;
  if (stays.empty()) {
    for (const std::uint32_t f : walls) keep[f] = 1;
    return keep;
  }
  std::vector<Vec3> places;
  for (const GridPoint& p : complex_.points) pace(), places.push_back(vector_of(p));
  const double reach = wall_share * max_deviation_ * grid_diagonal(complex_.points);
  const ClosestTriangle nearest(places, stays, &context);
  std::vector<char> far(walls.size(), 0);
  DisjointSets sheets(walls.size());
  std::unordered_map<std::uint64_t, std::uint32_t> at_edge;
  for (std::uint32_t i = 0; i < walls.size(); ++i) {
    if (i % 128 == 0) context.checkpoint();
    const Triangle& v = complex_.faces[walls[i]].v;
    far[i] =
        judge_reach({places[v[0]], places[v[1]], places[v[2]]}, nearest, reach) != ReachOfTriangle::Verdict::within;
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

/// Sheets that cannot be parted go where they are near to what stays, so that nothing touches.
PlacedBoundary SolidFromSoup::boundary_without_contacts(const CellLabels& labels, Report& report, Context& context) {
  SolidBoundaryOptions options{walls_to_keep(labels, context)};
  const double height = std::max(1.0, plate_share * max_deviation_ * grid_diagonal(complex_.points));
  constexpr int tries = 6;
  std::size_t contacts = 0;
  SheetMemory memory;
  std::vector<char> must_stay(complex_.faces.size(), 0);
  for (int i = 0;; ++i) {
    const SolidBoundary boundary = solid_boundary(complex_, labels, options, context);
    PlacedBoundary placed = part_sheets(complex_, boundary, height, memory, context);
    std::erase_if(placed.touching, [&](std::uint32_t f) { return must_stay[f] != 0; });
    if (!placed.touching.empty() && i < tries) {
      const std::size_t dropped = drop_where_near(placed.touching, boundary, options.keep_walls, must_stay, context);
      contacts += dropped;
      if (dropped > 0) continue;
    }
    if (boundary.dropped_walls > 0)
      report.figures["faces inside dropped"] = static_cast<double>(boundary.dropped_walls);
    if (boundary.doubled > 0) report.figures["faces kept as thin walls"] = static_cast<double>(boundary.doubled);
    if (contacts > 0) report.figures["walls dropped because their sides would touch"] = static_cast<double>(contacts);
    if (apart_) cut_tips(placed, height, context);
    return placed;
  }
}

/// Drops those walls that are near to all the others that the boundary has; the others must stay.
std::size_t SolidFromSoup::drop_where_near(const std::vector<std::uint32_t>& walls, const SolidBoundary& boundary,
                                           std::vector<char>& keep_walls, std::vector<char>& must_stay,
                                           const Context& context) const {
  Pace pace(context);
  for (const std::uint32_t f : walls) keep_walls[f] = 0;
  std::vector<Vec3> places;
  for (const GridPoint& p : complex_.points) pace(), places.push_back(vector_of(p));
  std::vector<Triangle> stays;
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t, pace())
    if (const std::uint32_t f = boundary.face[t]; boundary.sheet[t] == 0 || keep_walls[f])
      stays.push_back(complex_.faces[f].v);
  std::size_t dropped = walls.size();
  const auto keep = [&](std::uint32_t f) {
    keep_walls[f] = must_stay[f] = 1;
    --dropped;
  };
  if (stays.empty()) {
    std::ranges::for_each(walls, keep);
    return dropped;
  }
  const ClosestTriangle nearest(places, stays, &context);
  const double reach = wall_share * max_deviation_ * grid_diagonal(complex_.points);
  Pace searches(context, 128);
  for (const std::uint32_t f : walls) {
    searches();
    const Triangle& v = complex_.faces[f].v;
    if (judge_reach({places[v[0]], places[v[1]], places[v[2]]}, nearest, reach) == ReachOfTriangle::Verdict::beyond)
      keep(f);
  }
  return dropped;
}

/// Parts in which nothing was cut or parted keep their coordinates, unless that makes something cross.
std::vector<Vec3> SolidFromSoup::places_of(const PlacedBoundary& boundary, const CellLabels& labels,
                                           SurfaceContacts& contacts, Context& context) const {
  Pace pace(context);
  std::vector<char> touched(complex_.faces.size(), 0);  // of parts
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    pace();
    const std::uint32_t face = boundary.face[t];
    Triangle now;
    for (std::size_t k = 0; k < 3; ++k) now[k] = boundary.point[boundary.triangles[t][k]];
    Triangle was = closed_.triangles[complex_.faces[face].source];
    std::sort(now.begin(), now.end());
    std::sort(was.begin(), was.end());
    if (now != was) touched[labels.part[face]] = 1;
  }
  std::vector<Vec3> places;
  for (const GridPoint& p : boundary.points) pace(), places.push_back(frame_.to_space(p));
  std::vector<Vec3> restored = places;
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    pace();
    if (touched[labels.part[boundary.face[t]]]) continue;
    for (const std::uint32_t v : boundary.triangles[t])
      if (boundary.point[v] < vertex_of_point_.size() && !boundary.moved[v])
        restored[v] = soup_.points[vertex_of_point_[boundary.point[v]]];
  }
  contacts = surface_contacts(restored, boundary.triangles, context);
  if (contacts.none() || restored == places) return restored;
  contacts = surface_contacts(places, boundary.triangles, context);
  return places;
}

void SolidFromSoup::write(const PlacedBoundary& boundary, const std::vector<Vec3>& places, Report& report,
                          const Context& context) {
  Pace pace(context);
  TrianglePieces pieces;
  pieces.places = places;
  for (const std::uint32_t point : boundary.point)
    pieces.original.push_back(point < vertex_of_point_.size() ? vertex_of_point_[point] : no_index);
  for (std::size_t t = 0; t < boundary.triangles.size(); ++t) {
    pace();
    const std::uint32_t piece_of = complex_.faces[boundary.face[t]].source;
    Triangle within = closed_.triangles[piece_of];
    for (std::uint32_t& c : within) c = vertex_of_point_[c];
    pieces.triangles.push_back({boundary.triangles[t], within, triangle_of_given_[closed_.source[piece_of]]});
  }
  const std::vector<std::uint32_t> piece = replace_by_pieces(soup_, pieces, report, context);
  fillings_.clear();
  for (std::uint32_t t = 0; t < piece.size(); ++t)
    if (!complex_.faces[boundary.face[piece[t]]].original) fillings_.push_back(t);
}

}  // namespace tri
