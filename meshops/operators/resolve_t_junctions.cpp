#include "meshops/operators/resolve_t_junctions.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "meshops/joining/joined_points.hpp"
#include "meshops/joining/t_junctions.hpp"
#include "meshops/pace.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

/// The pieces of a triangle with further vertices on its sides, counter-clockwise as it is.
std::vector<Triangle> pieces(const Triangle& t, const std::array<std::vector<std::uint32_t>, 3>& on_side) {
  // A fan over the first divided side from the corner opposite; then the sides of its two outer triangles.
  for (std::size_t k = 0; k < 3; ++k) {
    if (on_side[k].empty()) continue;
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
    const auto &ab = on_side[k], &bc = on_side[(k + 1) % 3], &ca = on_side[(k + 2) % 3];
    std::vector<Triangle> result;
    const auto fan = [&](std::uint32_t apex, std::uint32_t from, const std::vector<std::uint32_t>& between,
                         std::uint32_t to) {
      std::uint32_t last = from;
      for (const std::uint32_t v : between) {
        result.push_back({apex, last, v});
        last = v;
      }
      result.push_back({apex, last, to});
    };
    fan(ab.front(), c, ca, a);
    for (std::size_t i = 1; i < ab.size(); ++i) result.push_back({c, ab[i - 1], ab[i]});
    fan(ab.back(), b, bc, c);
    return result;
  }
  return {t};
}

class JunctionResolver {
 public:
  JunctionResolver(const Soup& soup, Report& report) : work_(soup), report_(report) {
    for (std::uint32_t i = 0; i < soup.points.size(); ++i) cluster_wanted_.push_back(0);
  }

  /// @param junctions of one triangle
  void split(std::span<const TJunction> junctions) {
    const std::uint32_t t = junctions[0].triangle;
    const Triangle corners = work_.triangles[t];
    std::array<std::vector<std::uint32_t>, 3> on_side;
    // Judged with the vertices themselves, before anything is added.
    for (const TJunction& j : junctions) on_side[j.side].push_back(j.vertex);
    const Vec3 normal = area_vector(work_, corners);
    for (const Triangle& piece : pieces(corners, on_side)) {
      if ((area_vector(work_, piece) | normal) > 0) continue;
      ++report_.skipped["triangle would turn over"];
      return;
    }
    std::uint64_t sides = 0;
    for (auto& side : on_side) {
      sides += !side.empty();
      side.clear();
    }
    for (const TJunction& j : junctions) {
      const std::uint32_t v = add_point_between(work_, corners[j.side], corners[(j.side + 1) % 3], j.share);
      work_.points[v] = work_.points[j.vertex];
      on_side[j.side].push_back(v);
      ++report_.vertices_added;
      ++report_.figures["T-junctions"];
      for (const std::uint32_t end : {j.vertex, corners[j.side], corners[(j.side + 1) % 3]}) cluster_wanted_[end] = 1;
    }
    report_.figures["edges split"] += static_cast<double>(sides);
    const std::vector<Triangle> parts = pieces(corners, on_side);
    for (const Triangle& part : parts) {
      report_.touched_faces.push_back(static_cast<std::uint32_t>(work_.triangles.size()));
      add_triangle_in(work_, part, t);
    }
    gone_.push_back(t);
    report_.faces_added += parts.size() - 1;
  }

  void finish(Soup& soup, Context& context) {
    if (gone_.empty()) return;
    std::vector<char> keep(work_.triangles.size(), 1);
    for (const std::uint32_t t : gone_) keep[t] = 0;
    keep_triangles(work_, keep, &context);
    for (std::uint32_t& f : report_.touched_faces) f -= static_cast<std::uint32_t>(gone_.size());
    context.checkpoint();
    join(context);
    soup = std::move(work_);
  }

 private:
  /// Joins the new edges with what they lie on.
  void join(Context& context) {
    const std::vector<std::uint32_t> same = points_at_same_place(work_.points, &context);
    std::vector<char> wanted(work_.points.size(), 0);
    for (std::uint32_t i = 0; i < same.size(); ++i)
      if (i >= cluster_wanted_.size() || cluster_wanted_[i]) wanted[same[i]] = 1;
    std::vector<std::uint32_t> cluster(same.size());
    for (std::uint32_t i = 0; i < same.size(); ++i) cluster[i] = wanted[same[i]] ? same[i] : i;
    const JoinedPoints joined = join_points(work_, cluster, {.join_crowds = false, .opposite_only = true}, context);
    context.checkpoint();
    const std::size_t before = work_.points.size();
    apply_join(work_, joined.first, &context);
    if (joined.edges_joined > 0) report_.figures["edges joined"] = static_cast<double>(joined.edges_joined);
    // New vertices that became one with those they were put on were never there.
    const std::uint64_t gone = before - work_.points.size(), never = std::min(gone, report_.vertices_added);
    report_.vertices_added -= never;
    report_.vertices_removed = gone - never;
  }

  Soup work_;
  Report& report_;
  std::vector<char> cluster_wanted_;  // points whose place takes part in the joining
  std::vector<std::uint32_t> gone_;
};

}  // namespace

const OptionSchema& ResolveTJunctionsOptions::schema() {
  using O = ResolveTJunctionsOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("tolerance", &O::tolerance,
                  {.unit = "mm", .min = 0, .help = "how far from a boundary edge a vertex counts as being on it"})
          .number("relative-tolerance", &O::relative_tolerance,
                  {.min = 0, .max = 1, .help = "the same as a share of the diagonal; the larger is used"});
  return schema;
}

Report resolve_t_junctions(Soup& soup, const ResolveTJunctionsOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  context.progress("resolve-t-junctions", 0);
  check_soup(soup, &context);
  Report report;
  report.operation = "resolve-t-junctions";
  const double tolerance = length_tolerance(soup, options.tolerance, options.relative_tolerance);
  const std::vector<TJunction> junctions = find_t_junctions(soup, tolerance, context);
  context.progress("resolve-t-junctions", 0.5);
  if (junctions.empty()) {
    context.progress("resolve-t-junctions", 1);
    return report;
  }
  JunctionResolver resolver(soup, report);
  Pace pace(context, 1024);
  for (std::size_t begin = 0, end = 0; begin < junctions.size(); begin = end) {
    pace();
    while (end < junctions.size() && junctions[end].triangle == junctions[begin].triangle) ++end;
    resolver.split(std::span(junctions).subspan(begin, end - begin));
  }
  resolver.finish(soup, context);
  context.progress("resolve-t-junctions", 1);
  return report;
}

}  // namespace tri
