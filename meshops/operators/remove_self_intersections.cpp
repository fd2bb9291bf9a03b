#include "meshops/operators/remove_self_intersections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "meshops/crossings/refill_crossings.hpp"
#include "meshops/crossings/solid_check.hpp"
#include "meshops/crossings/split_crossings.hpp"
#include "meshops/search/disjoint_sets.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr double refill_share = 0.75;  ///< of what is allowed, where both methods may follow each other
constexpr std::size_t most_notes = 10;

std::string text_of(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]);
}

void tell_places_not_refilled(const std::vector<PlaceLeft>& places, double farthest, Report& report) {
  for (std::size_t i = 0; i < std::min(most_notes, places.size()); ++i) {
    const PlaceLeft& place = places[i];
    std::string why;
    switch (place.reason) {
      case PlaceLeft::Reason::shape:
        why = "no small patch around them is a disk";
        break;
      case PlaceLeft::Reason::crosses:
        why = "every filling would cross something";
        break;
      case PlaceLeft::Reason::too_far:
        why = fmt::format("the surface would move by more than {:.3g}", farthest);
        break;
    }
    report.notes.push_back(
        fmt::format("near {}, where {} pairs of triangles cross, nothing was cut out and refilled: {}",
                    text_of(place.at), place.pairs, why));
  }
}

/// The places where triangles cross at the end.
void tell_what_still_crosses(const Soup& soup, const std::vector<std::array<std::uint32_t, 2>>& pairs, Report& report) {
  DisjointSets sets(soup.triangles.size());
  for (const auto& pair : pairs) sets.join(pair[0], pair[1]);
  std::map<std::size_t, std::size_t> places;
  for (const auto& pair : pairs) ++places[sets.find(pair[0])];
  for (const auto& [triangle, count] : places) {
    if (report.notes.size() >= 2 * most_notes) return;
    const Triangle& t = soup.triangles[triangle];
    report.notes.push_back(fmt::format("near {}, {} pairs of triangles still cross",
                                       text_of((soup.points[t[0]] + soup.points[t[1]] + soup.points[t[2]]) / 3.0),
                                       count));
  }
}

}  // namespace

const OptionSchema& RemoveSelfIntersectionsOptions::schema() {
  using O = RemoveSelfIntersectionsOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("method", &O::method,
                  {{"automatic", CrossingMethod::automatic},
                   {"refill", CrossingMethod::refill},
                   {"split", CrossingMethod::split}},
                  {.help = "cut out and refill, cut along each other, or the one where that can be and else the other"})
          .number(
              "max-deviation", &O::max_deviation,
              {.unit = "of the diagonal", .min = 0, .max = 0.1, .help = "the surface moves nowhere farther than this"});
  return schema;
}

Report remove_self_intersections(Soup& soup, const RemoveSelfIntersectionsOptions& options, Context& context) {
  validate(options);
  check_soup(soup, &context);
  context.checkpoint();
  const auto done = [&](double share) { context.progress("remove-self-intersections", share); };
  Report report;
  report.operation = "remove-self-intersections";
  auto crossing = surface_contacts(soup.points, soup.triangles, context).crossing;
  done(crossing.empty() ? 1 : 0.2);
  if (crossing.empty()) return report;
  report.figures["crossing pairs"] = static_cast<double>(crossing.size());
  const double farthest = options.max_deviation * soup_diagonal(soup);
  double left_to_move = farthest;
  Soup work = soup;
  if (options.method != CrossingMethod::split) {
    const double allowed = options.method == CrossingMethod::refill ? farthest : refill_share * farthest;
    const RefillReport refilled = refill_crossings(work, crossing, allowed, report, context);
    tell_places_not_refilled(refilled.left, allowed, report);
    if (refilled.refilled > 0) {
      report.figures["places refilled"] = static_cast<double>(refilled.refilled);
      left_to_move -= allowed;
      crossing = surface_contacts(work.points, work.triangles, context).crossing;
    }
    done(0.5);
  }
  if (options.method != CrossingMethod::refill && !crossing.empty()) {
    const SplitReport split = split_crossings(work, crossing.size(), left_to_move, report, context);
    if (split.cut > 0) report.figures["faces cut"] = static_cast<double>(split.cut);
    if (split.left > 0)
      crossing = surface_contacts(work.points, work.triangles, context).crossing;
    else
      crossing.clear();
  }
  if (!crossing.empty()) {
    report.skipped["pairs that still cross"] = crossing.size();
    tell_what_still_crosses(work, crossing, report);
  }
  context.checkpoint();
  if (!report.unchanged()) soup = std::move(work);
  done(1);
  return report;
}

}  // namespace tri
