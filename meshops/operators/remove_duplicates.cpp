#include "meshops/operators/remove_duplicates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "meshops/pace.hpp"
#include "meshops/search/cancellable_sort.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

struct SortedTriangle {
  Triangle corners;
  std::uint32_t index = 0;
  bool operator<(const SortedTriangle& other) const {
    return corners != other.corners ? corners < other.corners : index < other.index;
  }
};

/// Whether an even number of swaps sorts the corners.
using Edge = std::pair<std::uint32_t, std::uint32_t>;
using Pair = std::array<std::uint32_t, 2>;  // the two triangles, the first one first

template <class Visit>
void for_edges(const Triangle& t, const Visit& visit) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = t[k], b = t[k == 2 ? 0 : k + 1];
    visit(Edge{std::min(a, b), std::max(a, b)}, a < b);
  }
}

/// For each pair whether it belongs to a wall between solids.
std::vector<char> walls(const Soup& soup, const std::vector<Pair>& pairs, const std::vector<char>& keep,
                        const Context& context) {
  Pace pace(context, 1024);
  struct AtEdge {
    std::vector<std::uint32_t> pairs;
    int forward = 0, backward = 0;  // further triangles
  };
  std::map<Edge, AtEdge> edges;
  std::vector<char> paired(soup.triangles.size(), 0);
  for (std::uint32_t p = 0; p < pairs.size(); ++p, pace()) {
    for (const std::uint32_t t : pairs[p]) paired[t] = 1;
    for_edges(soup.triangles[pairs[p][0]], [&](const Edge& e, bool) { edges[e].pairs.push_back(p); });
  }
  for (std::size_t t = 0; t < soup.triangles.size(); ++t, pace()) {
    if (!keep[t] || paired[t] || repeats_vertex(soup.triangles[t])) continue;
    for_edges(soup.triangles[t], [&](const Edge& e, bool forward) {
      if (const auto found = edges.find(e); found != edges.end())
        ++(forward ? found->second.forward : found->second.backward);
    });
  }
  DisjointSets patches(pairs.size());
  std::vector<char> rim_fits(pairs.size(), 1), has_rim(pairs.size(), 0);
  for (const auto& [edge, at] : edges)
    for (std::size_t i = 1; i < at.pairs.size(); ++i) patches.join(at.pairs[0], at.pairs[i]);
  for (const auto& [edge, at] : edges) {
    if (at.forward + at.backward == 0 && at.pairs.size() > 1) continue;  // inside of the patch
    const std::size_t patch = patches.find(at.pairs[0]);
    has_rim[patch] = 1;
    if (at.forward != at.backward || at.forward == 0) rim_fits[patch] = 0;
  }
  std::vector<char> result(pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const std::size_t patch = patches.find(p);
    result[p] = has_rim[patch] && rim_fits[patch];
  }
  return result;
}

void note_first(Report& report, const char* what, const std::vector<std::uint32_t>& triangles) {
  constexpr std::size_t named = 10;
  for (std::size_t i = 0; i < std::min(named, triangles.size()); ++i)
    report.notes.push_back(fmt::format("{}: triangle {}", what, triangles[i]));
  if (triangles.size() > named) report.notes.push_back(fmt::format("{}: {} more", what, triangles.size() - named));
  if (!triangles.empty()) report.figures[what] = static_cast<double>(triangles.size());
}

}  // namespace

const OptionSchema& RemoveDuplicatesOptions::schema() {
  using O = RemoveDuplicatesOptions;
  static const OptionSchema schema =
      Schema<O>().choice("opposite", &O::opposite,
                         {{"auto", OppositePairs::automatic},
                          {"keep", OppositePairs::keep},
                          {"one", OppositePairs::one},
                          {"none", OppositePairs::none}},
                         {.help = "how many stay of two triangles with the same corners that face opposite ways"});
  return schema;
}

Report remove_duplicates(Soup& soup, const RemoveDuplicatesOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("remove-duplicates", 0);
  check_soup(soup, &context);
  Pace pace(context);
  Report report;
  report.operation = "remove-duplicates";
  std::vector<SortedTriangle> sorted(soup.triangles.size());
  for (std::uint32_t i = 0; i < sorted.size(); ++i, pace()) {
    sorted[i] = {soup.triangles[i], i};
    std::sort(sorted[i].corners.begin(), sorted[i].corners.end());
  }
  cancellable_sort(sorted.begin(), sorted.end(), &context);
  context.progress("remove-duplicates", 0.5);

  std::vector<char> keep(soup.triangles.size(), 1);
  std::vector<std::uint32_t> same_way, removed_pairs, single_pairs;
  std::vector<Pair> pairs;
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    pace();
    while (end < sorted.size() && sorted[end].corners == sorted[begin].corners) ++end;
    if (end - begin == 1 || repeats_vertex(sorted[begin].corners)) continue;
    const std::uint32_t first = sorted[begin].index;
    bool has_opposite = false;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const std::uint32_t t = sorted[i].index;
      if (is_even(soup.triangles[t]) == is_even(soup.triangles[first]) || has_opposite) {
        keep[t] = 0;
        same_way.push_back(t);
      } else {
        has_opposite = true;
        pairs.push_back({first, t});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::sort(same_way.begin(), same_way.end());
  const std::vector<char> wall =
      options.opposite == OppositePairs::automatic ? walls(soup, pairs, keep, context) : std::vector<char>();
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    if (options.opposite == OppositePairs::keep) continue;
    keep[pairs[p][1]] = 0;
    const bool both = options.opposite == OppositePairs::none || (!wall.empty() && wall[p]);
    if (both) keep[pairs[p][0]] = 0;
    (both ? removed_pairs : single_pairs).push_back(pairs[p][0]);
  }
  note_first(report, "duplicates removed", same_way);
  note_first(report, "opposite pairs made one", single_pairs);
  note_first(report, "opposite pairs removed", removed_pairs);
  if (!pairs.empty()) report.figures["opposite pairs found"] = static_cast<double>(pairs.size());
  report.faces_removed = static_cast<std::uint64_t>(std::count(keep.begin(), keep.end(), 0));
  if (report.faces_removed > 0) {
    Soup work = soup;
    keep_triangles(work, keep, &context);
    soup = std::move(work);
  }
  context.progress("remove-duplicates", 1);
  return report;
}

}  // namespace tri
