#include "meshops/operators/remove_degenerate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "meshops/checks/surface_reach.hpp"
#include "meshops/crossings/predicates.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

/// A side this much shorter than the longest makes a needle, which is collapsed rather than split.
constexpr double needle_share = 1e-3;

/// What every move has to lower, the first member first.
struct Measure {
  int degenerate = 0;
  double squared_lengths = 0;  // of the longest sides of the degenerate triangles

  void add(const Measure& other) {
    degenerate += other.degenerate;
    squared_lengths += other.squared_lengths;
  }
  bool well_below(const Measure& other) const {
    return degenerate != other.degenerate ? degenerate < other.degenerate
                                          : squared_lengths < other.squared_lengths * (1 - 1e-9);
  }
};

/// Shape of one triangle: its sides in order of length.
struct TriangleForm {
  int longest = 0, shortest = 0;  // side k runs from corner k to the next
  double longest_squared = 0, shortest_squared = 0;
  double height_squared = 0;  // over the longest side
};

class Cleaner {
 public:
  Cleaner(const Soup& soup, const RemoveDegenerateOptions& options, Context& context)
      : work_(soup), options_(options), context_(context), alive_(soup.triangles.size(), 1),
        changed_(soup.triangles.size(), 0), drift_(soup.triangles.size(), 0), first_(soup.points.size() + 1, 0) {
    Pace pace(context);
    const auto for_corners = [&](const auto& visit) {
      for (std::uint32_t i = 0; i < work_.triangles.size(); ++i) {
        pace();
        const Triangle& t = work_.triangles[i];
        visit(t[0], i);
        if (t[1] != t[0]) visit(t[1], i);
        if (t[2] != t[0] && t[2] != t[1]) visit(t[2], i);
      }
    };
    for_corners([&](std::uint32_t v, std::uint32_t) { ++first_[v + 1]; });
    for (std::size_t v = 0; v < soup.points.size(); ++v, pace()) {
      used_before_.push_back(first_[v + 1] > 0);
      first_[v + 1] += first_[v];
    }
    given_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for_corners([&](std::uint32_t v, std::uint32_t i) { given_[next[v]++] = i; });
  }

  Report run(const std::vector<std::uint32_t>& found, Soup& result) {
    report_.operation = "remove-degenerate";
    report_.figures["degenerate triangles found"] = static_cast<double>(found.size());
    std::vector<std::uint32_t> waiting = found, again;
    for (bool moved = true; moved && !waiting.empty();) {
      moved = false;
      again.clear();
      for (std::size_t i = 0; i < waiting.size(); ++i) {
        if (i % 1024 == 0) context_.checkpoint();
        const std::uint32_t t = waiting[i];
        if (!alive_[t] || !measure(work_.triangles[t]).degenerate) continue;
        if (remove(t))
          moved = true;
        else
          again.push_back(t);
        for (const std::uint32_t n : std::exchange(new_degenerate_, {})) again.push_back(n);
      }
      std::sort(again.begin(), again.end());
      again.erase(std::unique(again.begin(), again.end()), again.end());
      std::swap(waiting, again);
    }
    std::uint64_t left = 0;
    for (const std::uint32_t t : waiting) left += alive_[t] && measure(work_.triangles[t]).degenerate;
    if (left > 0) report_.skipped["no move that does no harm"] = left;
    finish(result);
    return std::move(report_);
  }

  static TriangleForm shape_of(const Soup& soup, const Triangle& t) {
    TriangleForm s;
    for (int k = 0; k < 3; ++k) {
      const double squared = (soup.points[t[(k + 1) % 3]] - soup.points[t[k]]).sqrnorm();
      if (k == 0 || squared > s.longest_squared) s.longest_squared = squared, s.longest = k;
      if (k == 0 || squared < s.shortest_squared) s.shortest_squared = squared, s.shortest = k;
    }
    if (s.longest_squared > 0) s.height_squared = area_vector(soup, t).sqrnorm() / s.longest_squared;
    return s;
  }

  static bool is_flat(const Soup& soup, const Triangle& t, const TriangleForm& s, double flatness) {
    if (s.height_squared <= flatness * flatness * s.longest_squared) return true;
    // Far above the rounding of an area the corners are not on one line.
    return s.height_squared <= 1e-24 * s.longest_squared &&
           collinear_exact(soup.points[t[0]], soup.points[t[1]], soup.points[t[2]]);
  }

  static Measure measure(const Soup& soup, const Triangle& t, const RemoveDegenerateOptions& options) {
    if (repeats_vertex(t)) return {1, 0};
    const TriangleForm s = shape_of(soup, t);
    if (s.shortest_squared <= options.shortest_edge * options.shortest_edge || is_flat(soup, t, s, options.flatness))
      return {1, s.longest_squared};
    return {};
  }

 private:
  using List = std::vector<std::uint32_t>;

  Measure measure(const Triangle& t) const { return measure(work_, t, options_); }
  const Vec3& point(std::uint32_t v) const { return work_.points[v]; }

  /// Triangles at a vertex, and some that were there. Lists of their own only for vertices that were asked for: those
  /// of all would take as long to be given back as to be made.
  List& at(std::uint32_t v) {
    const auto [found, added] = at_.try_emplace(v);
    if (added) found->second.assign(given_.begin() + first_[v], given_.begin() + first_[v + 1]);
    return found->second;
  }
  const List& triangles_at(std::uint32_t v) {
    List& list = at(v);
    std::erase_if(list, [&](std::uint32_t t) { return !alive_[t] || !has(t, v); });
    return list;
  }
  bool has(std::uint32_t t, std::uint32_t v) const {
    return std::ranges::find(work_.triangles[t], v) != work_.triangles[t].end();
  }
  List triangles_at_edge(std::uint32_t a, std::uint32_t b) {
    List result;
    for (const std::uint32_t t : triangles_at(a))
      if (has(t, b)) result.push_back(t);
    return result;
  }
  static std::uint32_t third(const Triangle& t, std::uint32_t a, std::uint32_t b) {
    for (const std::uint32_t v : t)
      if (v != a && v != b) return v;
    return a;
  }
  static Triangle replaced(Triangle t, std::uint32_t from, std::uint32_t to) {
    std::ranges::replace(t, from, to);
    return t;
  }
  std::set<std::uint32_t> neighbors(std::uint32_t v) {
    std::set<std::uint32_t> result;
    for (const std::uint32_t t : triangles_at(v)) result.insert(work_.triangles[t].begin(), work_.triangles[t].end());
    result.erase(v);
    return result;
  }
  /// On an edge that has not just two triangles.
  bool special(std::uint32_t v) {
    for (const std::uint32_t n : neighbors(v))
      if (triangles_at_edge(v, n).size() != 2) return true;
    return false;
  }

  void kill(std::uint32_t t) { alive_[t] = 0; }
  void note_changed(std::uint32_t t) {
    changed_[t] = 1;
    if (measure(work_.triangles[t]).degenerate) new_degenerate_.push_back(t);
  }
  void add(const Triangle& triangle, std::uint32_t source, double drift) {
    const auto t = static_cast<std::uint32_t>(work_.triangles.size());
    add_triangle_in(work_, triangle, source);
    alive_.push_back(1);
    changed_.push_back(0);
    drift_.push_back(drift);
    for (const std::uint32_t v : triangle) at(v).push_back(t);
    note_changed(t);
  }

  bool remove(std::uint32_t t) {
    const Triangle corners = work_.triangles[t];
    if (repeats_vertex(corners)) {
      kill(t);
      return true;
    }
    for (const std::uint32_t other : triangles_at_edge(corners[0], corners[1])) {
      if (other == t || !has(other, corners[2])) continue;
      kill(t);  // the twin has the same corners, so it is degenerate as well
      kill(other);
      return true;
    }
    const TriangleForm shape = shape_of(work_, corners);
    const bool flat = is_flat(work_, corners, shape, options_.flatness);
    const bool needle = !flat || shape.shortest_squared <= needle_share * needle_share * shape.longest_squared;
    if (needle) return collapse(corners, shape) || (flat && split(t, shape));
    return split(t, shape) || collapse(corners, shape);
  }

  /// Takes a cap out by splitting its longest side, in all other triangles there, at the vertex opposite.
  bool split(std::uint32_t t, const TriangleForm& shape) {
    const Triangle corners = work_.triangles[t];
    const std::uint32_t a = corners[static_cast<std::size_t>(shape.longest)],
                        b = corners[static_cast<std::size_t>((shape.longest + 1) % 3)],
                        c = corners[static_cast<std::size_t>((shape.longest + 2) % 3)];
    Measure before = measure(corners), after;
    List others = triangles_at_edge(a, b);
    std::erase(others, t);
    std::vector<std::array<Triangle, 2>> halves;
    for (const std::uint32_t other : others) {
      const Triangle& o = work_.triangles[other];
      if (!triangles_at_edge(c, third(o, a, b)).empty()) return false;
      before.add(measure(o));
      halves.push_back({replaced(o, b, c), replaced(o, a, c)});
      for (const Triangle& half : halves.back()) {
        const Measure m = measure(half);
        after.add(m);
        if (m.degenerate == 0 && measure(o).degenerate == 0 && (area_vector(work_, half) | area_vector(work_, o)) <= 0)
          return false;
      }
    }
    if (!after.well_below(before)) return false;
    double drift = drift_[t];
    for (const std::uint32_t other : others) drift = std::max(drift, drift_[other]);
    if (!collinear_exact(point(a), point(b), point(c))) drift += std::sqrt(shape.height_squared);
    if (drift > options_.max_deviation) return false;
    kill(t);
    for (std::size_t i = 0; i < others.size(); ++i) {
      for (const Triangle& half : halves[i]) add(half, others[i], drift);
      kill(others[i]);
    }
    ++caps_;
    return true;
  }

  struct Collapse {
    std::uint32_t goes = 0, stays = 0;
    double displacement = 0;
    double drift = 0;  ///< of what changes, with all that was before
    List vanish, change;
  };

  /// What a collapse would do, if it is allowed.
  std::optional<Collapse> check(std::uint32_t goes, std::uint32_t stays, const TriangleForm& shape) {
    Collapse c{goes, stays, 0, 0, triangles_at_edge(goes, stays), {}};
    const double squared = (point(goes) - point(stays)).sqrnorm();
    if (c.vanish.size() == 2 && special(goes)) {
      if (special(stays) || squared > 0) return std::nullopt;
    } else if (c.vanish.size() != 2 && squared > needle_share * needle_share * shape.longest_squared) {
      return std::nullopt;
    }
    std::set<std::uint32_t> apexes;
    for (const std::uint32_t t : c.vanish) apexes.insert(third(work_.triangles[t], goes, stays));
    const std::set<std::uint32_t> around = neighbors(stays);
    for (const std::uint32_t n : neighbors(goes)) {
      if (n == stays || !around.contains(n)) continue;
      if (!apexes.contains(n)) return std::nullopt;
      const std::size_t one = triangles_at_edge(goes, n).size(), two = triangles_at_edge(stays, n).size();
      std::size_t between = 0;
      for (const std::uint32_t t : c.vanish) between += has(t, n);
      if (one + two - 2 * between > std::max(one, two)) return std::nullopt;
    }
    Measure before, after;
    for (const std::uint32_t t : c.vanish) before.add(measure(work_.triangles[t]));
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : triangles_at(goes)) {
      if (has(t, stays)) continue;
      const Triangle &old = work_.triangles[t], now = replaced(old, goes, stays);
      c.change.push_back(t);
      before.add(measure(old));
      after.add(measure(now));
      nearest = std::min(
          nearest,
          (closest_on_triangle({point(now[0]), point(now[1]), point(now[2])}, point(goes)) - point(goes)).norm());
      for (const std::uint32_t other : triangles_at(stays))
        if (other != t && has(other, now[0]) && has(other, now[1]) && has(other, now[2])) return std::nullopt;
    }
    if (!after.well_below(before)) return std::nullopt;
    c.displacement = c.change.empty() ? std::sqrt(squared) : nearest;
    if (c.displacement > options_.max_deviation) return std::nullopt;
    const double least_cosine = c.displacement * c.displacement > shape.height_squared ? 0.5 : 0;
    for (const std::uint32_t t : c.change) {
      const Triangle &old = work_.triangles[t], now = replaced(old, goes, stays);
      if (measure(old).degenerate || measure(now).degenerate) continue;
      const Vec3 m = area_vector(work_, old), n = area_vector(work_, now);
      if ((m | n) <= least_cosine * m.norm() * n.norm()) return std::nullopt;
    }
    return stays_within(c, std::sqrt(squared)) ? std::optional(c) : std::nullopt;
  }

  /// Whether what changes stays near to where the surface was at first; sets `drift`.
  /// @param length  of the edge: no place moves farther
  bool stays_within(Collapse& c, double length) {
    constexpr std::size_t most_pieces = 200;
    if (std::isinf(options_.max_deviation)) return true;
    for (const List* list : {&c.vanish, &c.change})
      for (const std::uint32_t t : *list) c.drift = std::max(c.drift, drift_[t]);
    const double left = options_.max_deviation - c.drift;
    if (length <= left) {
      c.drift += length;
      return true;
    }
    if (c.change.empty()) return false;
    std::vector<Triangle> old, now;
    for (const List* list : {&c.vanish, &c.change})
      for (const std::uint32_t t : *list) old.push_back(work_.triangles[t]);
    for (const std::uint32_t t : c.change) now.push_back(replaced(work_.triangles[t], c.goes, c.stays));
    const ClosestTriangle before(work_.points, old), after(work_.points, now);
    const auto within = [&](const std::vector<Triangle>& from, const ClosestTriangle& to) {
      return std::ranges::none_of(from, [&](const Triangle& t) {
        std::uint32_t hint = 0;
        return reach_of({point(t[0]), point(t[1]), point(t[2])}, to, left, most_pieces, hint).verdict !=
               ReachOfTriangle::Verdict::within;
      });
    };
    if (!within(old, after) || !within(now, before)) return false;
    c.drift = options_.max_deviation;
    return true;
  }

  bool collapse(const Triangle& corners, const TriangleForm& shape) {
    std::optional<Collapse> best;
    for (int k = 0; k < 3; ++k) {
      if (k == shape.longest && shape.longest != shape.shortest) continue;
      const std::uint32_t a = corners[static_cast<std::size_t>(k)], b = corners[static_cast<std::size_t>((k + 1) % 3)];
      for (const auto& [goes, stays] :
           {std::pair{std::max(a, b), std::min(a, b)}, std::pair{std::min(a, b), std::max(a, b)}}) {
        std::optional<Collapse> c = check(goes, stays, shape);
        if (c && (!best || c->displacement < best->displacement)) best = std::move(c);
      }
    }
    if (!best) return false;
    for (const std::uint32_t t : best->change) {
      carry_corner(*best, t);
      work_.triangles[t] = replaced(work_.triangles[t], best->goes, best->stays);
      drift_[t] = best->drift;
      at(best->stays).push_back(t);
    }
    for (const std::uint32_t t : best->vanish) kill(t);
    for (const std::uint32_t t : best->change) note_changed(t);
    ++needles_;
    return true;
  }

  /// A corner that moves takes the values of the vertex it moves to, if a vanishing triangle says what they are on this
  /// side of a seam.
  void carry_corner(const Collapse& c, std::uint32_t t) {
    if (work_.corner_scalars.empty()) return;
    const auto corner = [&](std::uint32_t triangle, std::uint32_t v) {
      return 3 * triangle + static_cast<std::size_t>(std::ranges::find(work_.triangles[triangle], v) -
                                                     work_.triangles[triangle].begin());
    };
    for (const std::uint32_t gone : c.vanish) {
      bool same = true;
      for (const auto& [name, values] : work_.corner_scalars)
        same &= values[corner(gone, c.goes)] == values[corner(t, c.goes)];
      if (!same) continue;
      for (auto& [name, values] : work_.corner_scalars) values[corner(t, c.goes)] = values[corner(gone, c.stays)];
      return;
    }
  }

  void finish(Soup& result) {
    Pace pace(context_);
    for (std::uint32_t t = 0, number = 0; t < alive_.size(); ++t) {
      pace();
      if (alive_[t] && changed_[t]) report_.touched_faces.push_back(number);
      number += alive_[t] != 0;
    }
    const std::size_t given = result.triangles.size();
    for (std::size_t t = 0; t < alive_.size(); ++t) {
      pace();
      report_.faces_removed += t < given && !alive_[t];
      report_.faces_added += t >= given && alive_[t];
    }
    if (caps_ > 0) report_.figures["caps removed"] = caps_;
    if (needles_ > 0) report_.figures["needles collapsed"] = needles_;
    context_.checkpoint();
    keep_triangles(work_, alive_, &context_);
    std::vector<char> used(work_.points.size(), 0);
    for (const Triangle& t : work_.triangles) {
      pace();
      for (const std::uint32_t v : t) used[v] = 1;
    }
    std::vector<std::uint32_t> number(used.size());
    std::uint32_t next = 0;
    for (std::size_t v = 0; v < used.size(); ++v, pace())
      number[v] = used[v] || !used_before_[v] ? next++ : dropped_point;
    report_.vertices_removed = used.size() - next;
    if (report_.vertices_removed > 0) renumber_points(work_, number, next, &context_);
    result = std::move(work_);
  }

  Soup work_;
  const RemoveDegenerateOptions& options_;
  Context& context_;
  std::vector<char> alive_, changed_, used_before_;
  std::vector<double> drift_;                 // of triangles: how far from where the surface was at first, at most
  std::vector<std::uint32_t> first_, given_;  // triangles at each vertex at first
  std::unordered_map<std::uint32_t, List> at_;
  List new_degenerate_;
  double caps_ = 0, needles_ = 0;
  Report report_;
};

}  // namespace

const OptionSchema& RemoveDegenerateOptions::schema() {
  using O = RemoveDegenerateOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("flatness", &O::flatness,
                  {.min = 0, .max = 0.1, .help = "height over longest side up to which a triangle is degenerate"})
          .number("shortest-edge", &O::shortest_edge, {.unit = "mm", .min = 0, .help = "edges no longer are collapsed"})
          .number("max-deviation", &O::max_deviation,
                  {.unit = "mm", .min = 0, .infinite = true, .help = "how far the surface may move"});
  return schema;
}

Report remove_degenerate(Soup& soup, const RemoveDegenerateOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("remove-degenerate", 0);
  check_soup(soup, &context);
  Pace pace(context);
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i, pace())
    if (Cleaner::measure(soup, soup.triangles[i], options).degenerate) found.push_back(i);
  Report report;
  report.operation = "remove-degenerate";
  if (!found.empty()) report = Cleaner(soup, options, context).run(found, soup);
  context.progress("remove-degenerate", 1);
  return report;
}

}  // namespace tri
