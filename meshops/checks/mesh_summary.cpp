#include "meshops/checks/mesh_summary.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "meshops/pace.hpp"
#include "meshops/search/cancellable_sort.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

// One side of a triangle; `corner` is 3 * triangle + k for the side from corner k to the next.
struct LinkedSide {
  std::uint64_t key;
  std::size_t corner;
  bool operator<(const LinkedSide& other) const { return key != other.key ? key < other.key : corner < other.corner; }
};

std::size_t next_corner(std::size_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

class Summary {
 public:
  Summary(const Soup& soup, MeshPlaces* places, const Context* context)
      : soup_(soup), places_(places), context_(context), pace_(context), fans_(soup.triangles.size() * 3),
        parts_(soup.triangles.size()) {}

  MeshSummary make() {
    s_.vertices = soup_.points.size();
    s_.triangles = soup_.triangles.size();
    measure_points();
    measure_triangles();
    walk_edges();
    count_fans();
    count_parts();
    count_duplicates();
    s_.euler = static_cast<std::int64_t>(s_.vertices - s_.unused_vertices) - static_cast<std::int64_t>(s_.edges) +
               static_cast<std::int64_t>(s_.triangles);
    s_.manifold = s_.nonmanifold_edges == 0 && s_.nonmanifold_vertices == 0 && s_.repeated_corners == 0;
    s_.oriented = s_.misoriented_edges == 0 && s_.nonmanifold_edges == 0;
    s_.closed = s_.triangles > 0 && s_.boundary_edges == 0;
    s_.volume = s_.closed && s_.oriented ? volume_ : 0;
    return s_;
  }

 private:
  std::uint32_t vertex(std::size_t corner) const { return soup_.triangles[corner / 3][corner % 3]; }

  void measure_points() {
    if (soup_.points.empty()) return;
    s_.box_min = s_.box_max = soup_.points[0];
    for (const Vec3& p : soup_.points) {
      pace_();
      s_.box_min.minimize(p);
      s_.box_max.maximize(p);
    }
  }

  void measure_triangles() {
    std::vector<bool> used(soup_.points.size(), false);
    const Vec3 middle = (s_.box_min + s_.box_max) * 0.5;  // keeps the volume's terms small
    for (const Triangle& t : soup_.triangles) {
      pace_();
      for (const std::uint32_t v : t) used[v] = true;
      const Vec3 a = soup_.points[t[0]] - middle, b = soup_.points[t[1]] - middle, c = soup_.points[t[2]] - middle;
      const double twice = ((b - a) % (c - a)).norm();
      s_.area += twice / 2;
      volume_ += (a | (b % c)) / 6;
      if (repeats_vertex(t))
        ++s_.repeated_corners;
      else if (twice == 0)
        ++s_.zero_area;
    }
    s_.unused_vertices = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), false));
    if (!places_) return;
    for (std::uint32_t v = 0; v < used.size(); ++v)
      if (!used[v]) places_->unused_vertices.push_back(v);
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t, pace_())
      if (repeats_vertex(soup_.triangles[t])) places_->repeated_corners.push_back(t);
  }

  void walk_edges() {
    std::vector<LinkedSide> sides;
    sides.reserve(soup_.triangles.size() * 3);
    for (std::size_t corner = 0; corner < soup_.triangles.size() * 3; ++corner, pace_()) {
      const std::uint64_t a = vertex(corner), b = vertex(next_corner(corner));
      if (!in_degenerate(corner)) sides.push_back({std::min(a, b) << 32 | std::max(a, b), corner});
    }
    cancellable_sort(sides.begin(), sides.end(), context_);
    double sum = 0;
    s_.shortest_edge = sides.empty() ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      pace_();
      while (end < sides.size() && sides[end].key == sides[begin].key) ++end;
      const double length =
          (soup_.points[vertex(sides[begin].corner)] - soup_.points[vertex(next_corner(sides[begin].corner))]).norm();
      sum += length;
      s_.shortest_edge = std::min(s_.shortest_edge, length);
      s_.longest_edge = std::max(s_.longest_edge, length);
      ++s_.edges;
      for (std::size_t i = begin + 1; i < end; ++i) join_over_edge(sides[begin].corner, sides[i].corner);
      if (end - begin == 1)
        boundary_.push_back(sides[begin].corner);
      else if (end - begin > 2)
        note_edge(s_.nonmanifold_edges, sides[begin].key, places_ ? &places_->nonmanifold_edges : nullptr);
      else if (vertex(sides[begin].corner) == vertex(sides[begin + 1].corner))
        note_edge(s_.misoriented_edges, sides[begin].key, places_ ? &places_->misoriented_edges : nullptr);
    }
    s_.boundary_edges = boundary_.size();
    if (s_.edges > 0) s_.mean_edge = sum / static_cast<double>(s_.edges);
  }

  static void note_edge(std::uint64_t& count, std::uint64_t key, std::vector<std::array<std::uint32_t, 2>>* places) {
    ++count;
    if (places) places->push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)});
  }

  void join_over_edge(std::size_t corner, std::size_t other) {
    parts_.join(corner / 3, other / 3);
    const bool same_direction = vertex(corner) == vertex(other);
    fans_.join(corner, same_direction ? other : next_corner(other));
    fans_.join(next_corner(corner), same_direction ? next_corner(other) : other);
  }

  void count_fans() {
    std::vector<std::uint32_t> fans_at(soup_.points.size(), 0);
    for (std::size_t corner = 0; corner < soup_.triangles.size() * 3; ++corner, pace_())
      if (!in_degenerate(corner) && fans_.find(corner) == corner) ++fans_at[vertex(corner)];
    s_.nonmanifold_vertices = static_cast<std::uint64_t>(
        std::count_if(fans_at.begin(), fans_at.end(), [](std::uint32_t n) { return n > 1; }));
    for (std::uint32_t v = 0; places_ && v < fans_at.size(); ++v)
      if (fans_at[v] > 1) places_->nonmanifold_vertices.push_back(v);
    // Every boundary edge ties two fans together; the chains of fans are the loops.
    DisjointSets chains(soup_.triangles.size() * 3);
    for (const std::size_t corner : boundary_)
      pace_(), chains.join(fans_.find(corner), fans_.find(next_corner(corner)));
    std::vector<std::size_t> roots;
    for (const std::size_t corner : boundary_) pace_(), roots.push_back(chains.find(fans_.find(corner)));
    std::sort(roots.begin(), roots.end());
    s_.boundary_loops = static_cast<std::uint64_t>(std::unique(roots.begin(), roots.end()) - roots.begin());
    if (places_) follow_loops();
  }

  /// From fan to fan: two boundary edges meet in each that has any, unless triangles around it are not manifold.
  void follow_loops() {
    std::map<std::size_t, std::vector<std::size_t>> at_fan;  // places in `boundary_`
    for (std::size_t i = 0; i < boundary_.size(); ++i, pace_())
      for (const std::size_t corner : {boundary_[i], next_corner(boundary_[i])})
        at_fan[fans_.find(corner)].push_back(i);
    std::vector<char> seen(boundary_.size(), 0);
    for (std::size_t start = 0; start < boundary_.size(); ++start) {
      if (seen[start]) continue;
      std::vector<std::uint32_t>& loop = places_->boundary_loops.emplace_back();
      for (std::size_t i = start, corner = boundary_[start]; !seen[i];) {
        pace_();
        seen[i] = 1;
        loop.push_back(vertex(corner));
        corner = corner == boundary_[i] ? next_corner(corner) : boundary_[i];  // the other end
        const std::size_t fan = fans_.find(corner);
        for (const std::size_t next : at_fan.at(fan)) {
          if (seen[next]) continue;
          i = next;
          corner = fans_.find(boundary_[next]) == fan ? boundary_[next] : next_corner(boundary_[next]);
          break;
        }
      }
    }
  }
  bool in_degenerate(std::size_t corner) const { return repeats_vertex(soup_.triangles[corner / 3]); }

  void count_parts() {
    std::vector<std::uint32_t> number(soup_.triangles.size(), none);
    if (places_) places_->component_of_triangle.assign(soup_.triangles.size(), none);
    for (std::size_t t = 0; t < soup_.triangles.size(); ++t, pace_()) {
      if (repeats_vertex(soup_.triangles[t])) continue;
      if (parts_.find(t) == t) number[t] = static_cast<std::uint32_t>(s_.components++);
      if (places_) places_->component_of_triangle[t] = number[parts_.find(t)];
    }
  }

  void count_duplicates() {
    using Keyed = std::pair<Triangle, std::uint32_t>;
    std::vector<Keyed> sorted;
    sorted.reserve(soup_.triangles.size());
    for (std::uint32_t i = 0; i < soup_.triangles.size(); ++i, pace_()) {
      sorted.emplace_back(soup_.triangles[i], i);
      std::sort(sorted.back().first.begin(), sorted.back().first.end());
    }
    cancellable_sort(sorted.begin(), sorted.end(), context_);
    for (std::size_t i = 1; i < sorted.size(); ++i, pace_()) {
      if (sorted[i].first != sorted[i - 1].first) continue;
      ++s_.duplicate_triangles;
      if (places_) places_->duplicate_triangles.push_back(sorted[i].second);
    }
    if (places_) std::sort(places_->duplicate_triangles.begin(), places_->duplicate_triangles.end());
  }

  static constexpr std::uint32_t none = 0xffffffff;
  const Soup& soup_;
  MeshPlaces* places_;
  const Context* context_;
  Pace pace_;
  DisjointSets fans_;   // corners of one vertex whose triangles are connected over edges at it
  DisjointSets parts_;  // triangles
  std::vector<std::size_t> boundary_;
  double volume_ = 0;
  MeshSummary s_;
};

}  // namespace

MeshSummary summarize(const Soup& soup, MeshPlaces* places, const Context* context) {
  if (places) *places = {};
  return Summary(soup, places, context).make();
}

}  // namespace tri
