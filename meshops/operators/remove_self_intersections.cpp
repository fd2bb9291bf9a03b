#include "meshops/operators/remove_self_intersections.hpp"

#include <algorithm>
#include <map>

#include "meshops/crossings/arrangement/crossing_complex.hpp"
#include "meshops/crossings/arrangement/grid_frame.hpp"
#include "meshops/crossings/solid_check.hpp"
#include "meshops/crossings/triangle_pieces.hpp"
#include "meshops/limits.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr double cutting_reach_share = 0x1p-20;  ///< of the extent: within it things are taken to touch if they cross again
constexpr int cutting_passes = 3;

/// The triangles on the grid, and which point is which vertex.
struct OnGrid {
  GridFrame frame;
  CrossingComplex complex;
  std::vector<std::uint32_t> vertex_of_point;

  explicit OnGrid(const Soup& soup) : frame(soup.points, GridFrame::doubles) {
    std::map<GridPoint, std::uint32_t> numbers;
    std::vector<std::uint32_t> number(soup.points.size(), no_index);
    for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
      Triangle t = soup.triangles[i];
      for (std::uint32_t& v : t) {
        if (number[v] == no_index) {
          const auto [it, added] =
              numbers.emplace(frame.to_grid(soup.points[v]), static_cast<std::uint32_t>(complex.points.size()));
          if (added) complex.points.push_back(it->first), vertex_of_point.push_back(v);
          number[v] = it->second;
        }
        v = number[v];
      }
      complex.faces.push_back({t, i, 1, true});
    }
  }
};

TrianglePieces pieces_of(const Soup& soup, const OnGrid& grid, bool restore) {
  TrianglePieces pieces;
  for (std::uint32_t p = 0; p < grid.complex.points.size(); ++p) {
    const bool old = p < grid.vertex_of_point.size();
    pieces.original.push_back(old ? grid.vertex_of_point[p] : no_index);
    pieces.places.push_back(old && restore ? soup.points[grid.vertex_of_point[p]] : grid.frame.to_space(grid.complex.points[p]));
  }
  for (const CrossingComplex::Face& f : grid.complex.faces) {
    Triangle v = f.v;
    if (f.net < 0) std::swap(v[1], v[2]);
    pieces.triangles.push_back({v, soup.triangles[f.source], f.source});
  }
  return pieces;
}

std::size_t crossings(const TrianglePieces& pieces, Context& context) {
  std::vector<Triangle> triangles;
  for (const TrianglePieces::Piece& p : pieces.triangles) triangles.push_back(p.v);
  return surface_contacts(pieces.places, triangles, context).crossing.size();
}

}  // namespace

const OptionSchema& RemoveSelfIntersectionsOptions::schema() {
  using O = RemoveSelfIntersectionsOptions;
  static const OptionSchema schema =
      Schema<O>().number("max-deviation", &O::max_deviation,
                         {.unit = "of the diagonal", .min = 0, .max = 0.1, .help = "no vertex moves farther than this"});
  return schema;
}

Report remove_self_intersections(Soup& soup, const RemoveSelfIntersectionsOptions& options, Context& context) {
  validate(options);
  check_soup(soup);
  context.checkpoint();
  Report report;
  report.operation = "remove-self-intersections";
  std::size_t left = surface_contacts(soup.points, soup.triangles, context).crossing.size();
  const auto done = [&] {
    if (left > 0) report.skipped["pairs that still cross"] = left;
    context.progress("remove-self-intersections", 1);
    return report;
  };
  if (left == 0) return done();
  report.figures["crossing pairs"] = static_cast<double>(left);
  Vec3 low = soup.points[soup.triangles[0][0]], high = low;
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) low.minimize(soup.points[v]), high.maximize(soup.points[v]);
  const double farthest = options.max_deviation * (high - low).norm();

  Soup work = soup;
  for (int pass = 0; pass < cutting_passes && left > 0; ++pass) {
    OnGrid grid(work);
    const CrossingReport cut = resolve_crossings(grid.complex, grid.frame.steps_in(cutting_reach_share), farthest / grid.frame.step(), context);
    TrianglePieces pieces = pieces_of(work, grid, true);
    std::size_t now = crossings(pieces, context);
    if (now > 0) {
      pieces = pieces_of(work, grid, false);
      now = crossings(pieces, context);
    }
    if (now >= left) break;
    left = now;
    report.figures["faces cut"] += static_cast<double>(cut.cut);
    replace_by_pieces(work, pieces, report);
  }
  if (!report.unchanged()) soup = std::move(work);
  return done();
}

}  // namespace tri
