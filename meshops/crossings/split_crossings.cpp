#include "meshops/crossings/split_crossings.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "meshops/crossings/arrangement/crossing_complex.hpp"
#include "meshops/crossings/arrangement/grid_frame.hpp"
#include "meshops/crossings/arrangement/grid_hash.hpp"
#include "meshops/crossings/solid_check.hpp"
#include "meshops/crossings/triangle_pieces.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/search/number_map.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr double cutting_reach_share = 0x1p-20;  ///< of the extent: within it things are taken to touch if they cross
                                                 ///< again
constexpr int cutting_passes = 3;

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

/// The triangles on the grid, and which vertex is which point.
struct OnGrid {
  GridFrame frame;
  CrossingComplex complex;
  std::vector<std::uint32_t> point;   ///< of each vertex of the soup: that of the complex
  std::vector<std::uint32_t> vertex;  ///< of each point of the complex at first: a vertex that it is

  OnGrid(const Soup& soup, const Context& context)
      : frame(soup, GridFrame::doubles), point(soup.points.size(), no_index) {
    Pace pace(context);
    NumberMap<GridPoint, GridHash> numbers(soup.points.size());
    for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
      pace();
      Triangle t = soup.triangles[i];
      for (std::uint32_t& v : t) {
        if (point[v] == no_index) {
          const GridPoint place = frame.to_grid(soup.points[v]);
          const auto [same, added] = numbers.insert(place, static_cast<std::uint32_t>(complex.points.size()));
          if (added) complex.points.push_back(place), vertex.push_back(v);
          point[v] = same;
        }
        v = point[v];
      }
      complex.faces.push_back({t, i, 1, true});
    }
  }
};

/// The pieces; the soup's vertices keep their numbers, and a corner that the triangle had keeps its vertex.
/// @param restore  vertices keep their coordinates, too
TrianglePieces pieces_of(const Soup& soup, const OnGrid& grid, bool restore, const Context& context) {
  Pace pace(context);
  TrianglePieces pieces;
  for (std::uint32_t v = 0; v < soup.points.size(); ++v) {
    pace();
    pieces.original.push_back(v);
    pieces.places.push_back(restore || grid.point[v] == no_index
                                ? soup.points[v]
                                : grid.frame.to_space(grid.complex.points[grid.point[v]]));
  }
  for (std::size_t p = grid.vertex.size(); p < grid.complex.points.size(); ++p) {
    pieces.original.push_back(no_index);
    pieces.places.push_back(grid.frame.to_space(grid.complex.points[p]));
  }
  for (const CrossingComplex::Face& f : grid.complex.faces) {
    pace();
    const Triangle& of = soup.triangles[f.source];
    Triangle v = f.v;
    for (std::uint32_t& corner : v) {
      const auto own = std::ranges::find(of, corner, [&](std::uint32_t u) { return grid.point[u]; });
      if (own != of.end())
        corner = *own;
      else if (corner < grid.vertex.size())
        corner = grid.vertex[corner];
      else
        corner += static_cast<std::uint32_t>(soup.points.size() - grid.vertex.size());
    }
    if (f.net < 0) std::swap(v[1], v[2]);
    pieces.triangles.push_back({v, of, f.source});
  }
  return pieces;
}

Pairs crossings(const TrianglePieces& pieces, Context& context) {
  std::vector<Triangle> triangles;
  Pace pace(context);
  for (const TrianglePieces::Piece& p : pieces.triangles) pace(), triangles.push_back(p.v);
  return surface_contacts(pieces.places, triangles, context).crossing;
}

/// Moves the vertices of triangles that cross to the grid, and all of them if that is not enough.
/// @param crossing  of `pieces`; on return those that are left
void move_to_grid(TrianglePieces on_grid, TrianglePieces& pieces, Pairs& crossing, Context& context) {
  constexpr int rounds = 3;
  for (int round = 0; round < rounds && !crossing.empty(); ++round) {
    for (const auto& pair : crossing)
      for (const std::uint32_t p : pair)
        for (const std::uint32_t v : pieces.triangles[p].v) pieces.places[v] = on_grid.places[v];
    crossing = crossings(pieces, context);
  }
  if (crossing.empty()) return;
  if (Pairs there = crossings(on_grid, context); there.size() < crossing.size()) {
    pieces = std::move(on_grid);
    crossing = std::move(there);
  }
}

/// Puts the triangles back of places where it became no better. @return how many places
std::size_t undo_where_no_better(const Soup& soup, const Pairs& before, const Pairs& after, TrianglePieces& pieces,
                                 const Context& context) {
  Pace pace(context);
  const std::size_t n = soup.triangles.size();
  const auto source = [&](std::uint32_t piece) { return pieces.triangles[piece].source; };
  std::vector<char> whole(n, 0);
  for (const TrianglePieces::Piece& p : pieces.triangles) {
    pace();
    const Triangle& t = soup.triangles[p.source];
    bool same = true;
    for (const std::uint32_t v : p.v) same &= std::ranges::find(t, v) != t.end();
    whole[p.source] |= same;
  }
  DisjointSets places(n);
  for (const auto& pair : before) places.join(pair[0], pair[1]);
  for (const auto& pair : after) places.join(source(pair[0]), source(pair[1]));
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> at_side;
  for (std::uint32_t t = 0; t < n; ++t, pace())
    for (std::size_t k = 0; !whole[t] && k < 3; ++k) {
      const std::uint32_t a = soup.triangles[t][k], b = soup.triangles[t][(k + 1) % 3];
      const auto [other, first] = at_side.emplace(std::array{std::min(a, b), std::max(a, b)}, t);
      if (!first) places.join(other->second, t);
    }
  std::map<std::size_t, std::array<std::size_t, 2>> counts;
  for (const auto& pair : before) ++counts[places.find(pair[0])][0];
  for (const auto& pair : after) ++counts[places.find(source(pair[0]))][1];
  const auto worse = [&](std::uint32_t t) {
    const auto place = counts.find(places.find(t));
    return place != counts.end() && place->second[1] > 0 && place->second[1] >= place->second[0];
  };
  std::erase_if(pieces.triangles, [&](const TrianglePieces::Piece& p) {
    pace();
    return worse(p.source);
  });
  for (std::uint32_t t = 0; t < n; ++t, pace())
    if (worse(t)) pieces.triangles.push_back({soup.triangles[t], soup.triangles[t], t});
  return static_cast<std::size_t>(std::ranges::count_if(
      counts, [](const auto& place) { return place.second[1] > 0 && place.second[1] >= place.second[0]; }));
}

/// Counts of a further change, after which triangle i is what `before[i]` says.
void append(Report& report, const Report& more, const std::vector<std::uint32_t>& before, const Context& context) {
  Pace pace(context);
  report.vertices_added += more.vertices_added;
  report.vertices_removed += more.vertices_removed;
  report.vertices_moved += more.vertices_moved;
  report.faces_added += more.faces_added;
  report.faces_removed += more.faces_removed;
  std::vector<std::uint32_t> touched = more.touched_faces;
  std::ranges::sort(report.touched_faces);
  for (std::uint32_t t = 0; t < before.size(); ++t, pace())
    if (std::ranges::binary_search(report.touched_faces, before[t])) touched.push_back(t);
  std::ranges::sort(touched);
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  report.touched_faces = std::move(touched);
}

}  // namespace

SplitReport split_crossings(Soup& soup, std::size_t crossing, double farthest, Report& report, Context& context) {
  SplitReport result{0, 0, crossing};
  Soup work = soup;
  for (int pass = 0; pass < cutting_passes && result.left > 0 && result.undone == 0; ++pass) {
    OnGrid grid(work, context);
    const CrossingReport cut = resolve_crossings(grid.complex, grid.frame.steps_in(cutting_reach_share),
                                                 farthest / grid.frame.step(), context);
    TrianglePieces pieces = pieces_of(work, grid, true, context);
    Pairs now = crossings(pieces, context);
    if (!now.empty()) move_to_grid(pieces_of(work, grid, false, context), pieces, now, context);
    std::size_t undone = 0;
    if (!now.empty()) {
      undone = undo_where_no_better(work, surface_contacts(work.points, work.triangles, context).crossing, now, pieces,
                                    context);
      if (undone > 0) now = crossings(pieces, context);
    }
    if (now.size() >= result.left) break;
    result.left = now.size();
    result.undone = undone;
    result.cut += cut.cut;
    Report step;
    const std::vector<std::uint32_t> piece = replace_by_pieces(work, pieces, step, context);
    std::vector<std::uint32_t> source;
    for (const std::uint32_t p : piece) source.push_back(pieces.triangles[p].source);
    append(report, step, source, context);
  }
  if (result.left < crossing) soup = std::move(work);
  return result;
}

}  // namespace tri
