#include "meshops/crossings/triangle_pieces.hpp"

#include <algorithm>

#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

/// Appends a point of a triangle's plane; the corners' attributes are interpolated.
std::uint32_t add_point_in(Soup& soup, const Triangle& t, const Vec3& p) {
  const Vec3 &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
  const Vec3 n = (b - a) % (c - a);
  const double size = n.sqrnorm();
  Vec3 w(1, 0, 0);
  if (size > 0) w = Vec3(((b - p) % (c - p)) | n, ((c - p) % (a - p)) | n, ((a - p) % (b - p)) | n) / size;
  for (int k = 0; k < 3; ++k) w[k] = std::clamp(w[k], 0.0, 1.0);
  w /= w[0] + w[1] + w[2];
  const std::uint32_t between = add_point_between(soup, t[0], t[1], w[0] + w[1] > 0 ? w[1] / (w[0] + w[1]) : 0);
  move_point_between(soup, between, t[2], w[2]);
  soup.points[between] = p;
  return between;
}

}  // namespace

std::vector<std::uint32_t> replace_by_pieces(Soup& soup, const TrianglePieces& pieces, Report& report,
                                             const Context& context) {
  Pace pace(context);
  const std::vector<Vec3>& places = pieces.places;
  const std::size_t old_points = soup.points.size(), old_triangles = soup.triangles.size();
  std::vector<std::uint32_t> name(places.size(), no_index);
  std::vector<char> taken(old_points, 0);
  std::vector<char> kept(old_triangles, 0);
  std::vector<std::pair<Triangle, std::uint32_t>> added;
  for (const TrianglePieces::Piece& piece : pieces.triangles) {
    pace();
    Triangle named;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = piece.v[k];
      if (name[v] == no_index) {
        const std::uint32_t original = pieces.original[v];
        if (original != no_index && !taken[original]) {
          name[v] = original;
          taken[original] = 1;
        } else if (original != no_index) {
          name[v] = copy_point(soup, original);
        } else {
          name[v] = add_point_in(soup, piece.within, places[v]);
        }
      }
      named[k] = name[v];
    }
    added.emplace_back(named, piece.source);
  }
  // A triangle that is the same as before keeps its place, so that its attributes need no interpolation.
  std::vector<std::pair<Triangle, std::uint32_t>> fresh;
  std::vector<std::uint32_t> piece_kept(old_triangles, no_index), fresh_pieces;
  for (std::uint32_t i = 0; i < added.size(); ++i) {
    pace();
    const auto& [t, source] = added[i];
    const Triangle& was = soup.triangles[source];
    bool same = false;
    for (std::size_t k = 0; k < 3; ++k) same |= t == Triangle{was[k], was[(k + 1) % 3], was[(k + 2) % 3]};
    if (same && !kept[source]) {
      kept[source] = 1;
      piece_kept[source] = i;
    } else {
      fresh.emplace_back(t, source);
      fresh_pieces.push_back(i);
    }
  }
  for (std::size_t v = 0; v < name.size(); ++v) {
    pace();
    if (name[v] == no_index) continue;
    if (name[v] < old_points)
      report.vertices_moved += soup.points[name[v]] != places[v];
    else
      ++report.vertices_added;
  }
  for (const auto& [t, source] : fresh) pace(), add_triangle_in(soup, t, source);
  for (std::size_t v = 0; v < name.size(); ++v)
    if (name[v] != no_index) soup.points[name[v]] = places[v];
  report.faces_added = fresh.size();
  kept.resize(soup.triangles.size(), 1);
  report.faces_removed = static_cast<std::uint64_t>(std::count(kept.begin(), kept.end(), 0));
  keep_triangles(soup, kept, &context);
  for (std::size_t t = soup.triangles.size() - fresh.size(); t < soup.triangles.size(); ++t)
    report.touched_faces.push_back(static_cast<std::uint32_t>(t));
  // Vertices that no triangle uses go.
  std::vector<char> used(soup.points.size(), 0);
  for (const Triangle& t : soup.triangles) {
    pace();
    for (const std::uint32_t v : t) used[v] = 1;
  }
  std::vector<std::uint32_t> number(soup.points.size());
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    pace();
    number[v] = used[v] ? count++ : dropped_point;
    if (!used[v] && v < old_points) ++report.vertices_removed;
  }
  renumber_points(soup, number, count, &context);
  std::erase(piece_kept, no_index);
  piece_kept.insert(piece_kept.end(), fresh_pieces.begin(), fresh_pieces.end());
  return piece_kept;
}

}  // namespace tri
