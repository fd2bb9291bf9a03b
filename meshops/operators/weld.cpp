#include "meshops/operators/weld.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "meshops/joining/joined_points.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/nearest_points.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

struct NearPair {
  double squared_distance = 0;
  std::uint32_t a = 0, b = 0;
  bool operator<(const NearPair& other) const {
    return std::tie(squared_distance, a, b) < std::tie(other.squared_distance, other.a, other.b);
  }
};

/// Clusters of loose points that are at most `tolerance` wide and hold no two points of one triangle.
class Clusters {
 public:
  Clusters(const Soup& soup, std::vector<std::uint32_t> start, double tolerance, const Context& context)
      : soup_(soup), cluster_(std::move(start)), limit_(tolerance * tolerance), members_(soup.points.size()) {
    Pace pace(context);
    for (std::uint32_t i = 0; i < cluster_.size(); ++i, pace()) members_[cluster_[i]].push_back(i);
  }

  std::vector<std::uint32_t> run(Context& context) {
    const std::vector<NearPair> pairs = near_pairs(context);
    if (!pairs.empty()) list_neighbors(context);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (i % 65536 == 0) context.checkpoint();
      unite(pairs[i].a, pairs[i].b);
    }
    return std::move(cluster_);
  }

 private:
  std::vector<NearPair> near_pairs(Context& context) const {
    constexpr std::size_t most = 32;
    const std::vector<char> loose = points_on_loose_edges(soup_, context);
    std::vector<std::uint32_t> source;
    std::vector<Vec3> places;
    for (std::uint32_t i = 0; i < soup_.points.size(); ++i) {
      if (!loose[i]) continue;
      source.push_back(i);
      places.push_back(soup_.points[i]);
    }
    const NearestPoints tree(places, &context);
    std::vector<NearPair> pairs;
    std::vector<NearestPoints::Neighbor> near;
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      if (i % 4096 == 0) context.checkpoint();
      tree.nearest(places[i], most, near);
      for (const auto& n : near)
        if (n.index != i && n.squared_distance <= limit_)
          pairs.push_back(
              {n.squared_distance, std::min(source[i], source[n.index]), std::max(source[i], source[n.index])});
    }
    Pace pace(context);
    std::sort(pairs.begin(), pairs.end(), [&](const NearPair& a, const NearPair& b) {
      pace();
      return a < b;
    });
    pairs.erase(std::unique(pairs.begin(), pairs.end(),
                            [](const NearPair& p, const NearPair& q) { return p.a == q.a && p.b == q.b; }),
                pairs.end());
    return pairs;
  }

  void list_neighbors(const Context& context) {
    Pace pace(context);
    neighbors_.resize(soup_.points.size());
    for (const Triangle& t : soup_.triangles) {
      pace();
      for (int k = 0; k < 3; ++k)
        for (int m = 0; m < 3; ++m)
          if (t[k] != t[m]) neighbors_[t[k]].push_back(t[m]);
    }
  }

  bool may_unite(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) const {
    for (const std::uint32_t i : a)
      for (const std::uint32_t j : b)
        if ((soup_.points[i] - soup_.points[j]).sqrnorm() > limit_ ||
            std::ranges::find(neighbors_[i], j) != neighbors_[i].end())
          return false;
    return true;
  }

  void unite(std::uint32_t a, std::uint32_t b) {
    a = cluster_[a], b = cluster_[b];
    if (a == b) return;
    if (b < a) std::swap(a, b);
    if (!may_unite(members_[a], members_[b])) return;
    for (const std::uint32_t i : members_[b]) cluster_[i] = a;
    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
    members_[b].clear();
  }

  const Soup& soup_;
  std::vector<std::uint32_t> cluster_;
  double limit_;
  std::vector<std::vector<std::uint32_t>> members_;
  std::vector<std::vector<std::uint32_t>> neighbors_;
};

std::uint64_t count_moved(const Soup& soup, const JoinedPoints& joined) {
  std::uint64_t moved = 0;
  for (std::size_t i = 0; i < joined.first.size(); ++i) moved += soup.points[joined.first[i]] != soup.points[i];
  return moved;
}

void add_figure(Report& report, const char* name, std::uint64_t count) {
  if (count > 0) report.figures[name] += static_cast<double>(count);
}
void set_skipped(Report& report, const char* reason, std::uint64_t count) {
  if (count > 0) report.skipped[reason] += count;
}

/// Adds what a second round joined of what the first one left.
void compose(std::vector<std::uint32_t>& first, const std::vector<std::uint32_t>& second) {
  std::vector<std::uint32_t> source;  // the points that the first round left, by their new number
  std::vector<std::uint32_t> number(first.size());
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    if (first[i] == i) {
      number[i] = static_cast<std::uint32_t>(source.size());
      source.push_back(i);
    }
    first[i] = source[second[number[first[i]]]];
  }
}

}  // namespace

const OptionSchema& WeldOptions::schema() {
  using O = WeldOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number(
              "tolerance", &O::tolerance,
              {.unit = "mm", .min = 0, .help = "loose vertices no farther apart become one; 0: only coincident ones"})
          .boolean("touching", &O::touching, {.help = "coincident vertices become one even if they only touch there"});
  return schema;
}

Report weld(Soup& soup, const WeldOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("weld", 0);
  check_soup(soup, &context);
  Report report;
  report.operation = "weld";
  const std::vector<std::uint32_t> coincident = points_at_same_place(soup.points, &context);
  context.checkpoint();
  JoinedPoints joined;
  if (options.touching)
    joined.first = coincident;
  else
    joined = join_points(soup, coincident, {.join_crowds = true}, context);
  std::vector<std::uint32_t> first = std::move(joined.first);
  add_figure(report, "edges joined", joined.edges_joined);
  add_figure(report, "edges of three or more triangles made", joined.edges_crowded);
  std::uint64_t apart = joined.points_apart;
  context.progress("weld", 0.4);

  if (options.tolerance > 0) {
    Soup shape{soup.points, soup.triangles, {}, {}, {}, {}, {}, {}};
    apply_join(shape, first, &context);
    std::vector<std::uint32_t> own(shape.points.size());
    for (std::uint32_t i = 0; i < own.size(); ++i) own[i] = i;
    std::vector<std::uint32_t> cluster = Clusters(shape, std::move(own), options.tolerance, context).run(context);
    JoinedPoints near = join_points(shape, cluster, {}, context);
    const std::uint64_t turned = keep_from_turning_over(shape, cluster, {}, context, near, [&](const JoinedPoints& j) {
      std::vector<Vec3> moved(shape.points.size());
      for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = shape.points[j.first[i]];
      return moved;
    });
    add_figure(report, "edges joined", near.edges_joined);
    set_skipped(report, "triangle would turn over", turned);
    report.vertices_moved = count_moved(shape, near);
    apart = near.points_apart;
    compose(first, near.first);
  }
  set_skipped(report, "vertices that only touch, or would crowd an edge", apart);
  context.checkpoint();

  std::vector<char> has_joined(soup.points.size(), 0);
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    report.vertices_removed += first[i] != i;
    if (first[i] != i) has_joined[first[i]] = 1;
  }
  if (report.vertices_removed == 0) {
    context.progress("weld", 1);
    return report;
  }
  std::uint32_t number = 0;
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    if (has_joined[i]) report.touched_vertices.push_back(number);
    number += first[i] == i;
  }
  Soup work = soup;
  report.faces_removed = apply_join(work, first, &context);
  soup = std::move(work);
  context.progress("weld", 1);
  return report;
}

}  // namespace tri
