#include "meshops/operators/make_solid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "meshops/checks/shells.hpp"
#include "meshops/crossings/arrangement/solid_from_soup.hpp"
#include "meshops/crossings/part_touching.hpp"
#include "meshops/crossings/solid_check.hpp"
#include "meshops/pace.hpp"
#include "meshops/single_precision.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

constexpr int solid_passes = 4;
constexpr double parted_share = 1.0 / 16;  ///< of max_deviation: how far vertices that touch move at last

constexpr std::size_t named = 10;

Vec3 middle_of(const Soup& soup, std::uint32_t t) {
  const Triangle& v = soup.triangles[t];
  return (soup.points[v[0]] + soup.points[v[1]] + soup.points[v[2]]) / 3.0;
}

/// A note for each of the first few.
void name_places(Report& report, const char* what, const char* how, const std::vector<std::uint32_t>& list,
                 const auto& place) {
  for (std::size_t i = 0; i < std::min(named, list.size()); ++i) {
    const Vec3 p = place(list[i]);
    report.notes.push_back(fmt::format("{} {} {} ({:.6g}, {:.6g}, {:.6g})", what, list[i], how, p[0], p[1], p[2]));
  }
}

/// To the nearest numbers of single precision.
void round_points(Soup& soup, Report& report, const Context& context) {
  Pace pace(context);
  for (Vec3& p : soup.points) {
    pace();
    const Vec3 rounded = rounded_to_floats(p);
    report.vertices_moved += rounded != p;
    p = rounded;
  }
}

/// Plates thinner than what rounding moves may come to face inward.
void turn_outward(Soup& soup, Report& report, Context& context) {
  Shells shells = find_shells(soup, context);
  if (std::ranges::all_of(shells.shells, [](const Shell& s) { return s.volume >= 0; })) return;
  find_depths(soup, shells, context);
  for (const Shell& shell : shells.shells) {
    if (!is_inside_out(shell)) continue;
    for (const std::uint32_t t : shell.triangles) reverse_triangle(soup, t);
    report.faces_reversed += shell.triangles.size();
    ++report.figures["shells that rounding turned inward"];
    report.touched_faces.insert(report.touched_faces.end(), shell.triangles.begin(), shell.triangles.end());
  }
  std::ranges::sort(report.touched_faces);
  report.touched_faces.erase(std::unique(report.touched_faces.begin(), report.touched_faces.end()),
                             report.touched_faces.end());
}

void tell_what_is_left(const Soup& soup, const SurfaceContacts& left, bool touching_counts, Report& report,
                       const Context& context) {
  if (!left.crossing.empty()) report.skipped["pairs that still cross"] = left.crossing.size();
  if (!left.flat.empty()) report.skipped["triangles without area"] = left.flat.size();
  std::vector<std::uint32_t> crossing;
  for (const auto& pair : left.crossing) crossing.push_back(pair[0]);
  const auto middle = [&](std::uint32_t t) { return middle_of(soup, t); };
  name_places(report, "triangle", "still crosses another near", crossing, middle);
  name_places(report, "triangle", "has no area, at", left.flat, middle);
  const std::vector<std::uint32_t> touching = touching_vertices(soup, &context);
  if (touching.empty()) return;
  if (!touching_counts) {  // a file with indices keeps them apart
    report.figures["vertices that touch others"] = static_cast<double>(touching.size());
    return;
  }
  report.skipped["vertices that still touch others"] = touching.size();
  name_places(report, "vertex", "still touches another at", touching, [&](std::uint32_t v) { return soup.points[v]; });
}

struct Attempt {
  Soup soup;
  Report report;
  SurfaceContacts left;
  std::size_t touching = 0;
  std::vector<std::uint32_t> fillings;

  bool clean() const { return left.none() && touching == 0; }
  bool better_than(const Attempt& other) const {
    const auto defects = [](const Attempt& a) {
      return std::array{a.left.crossing.size() + a.left.flat.size(), a.touching};
    };
    return defects(*this) < defects(other);
  }
};

/// Makes a solid of the result of an attempt once more. @return whether anything changed
bool go_on(Attempt& a, const MakeSolidOptions& options, int finest, bool floats, Context& context) {
  Report again;
  a.left = SolidFromSoup(a.soup, options.max_deviation, options.keep_walls, finest, floats, true, a.fillings)
               .run(again, false, context);
  if (again.unchanged()) return false;
  double& count = a.report.figures["passes"];
  count = std::max(1.0, count) + 1;
  a.report.touched_faces = again.touched_faces;
  a.report.vertices_added += again.vertices_added;
  a.report.vertices_removed += again.vertices_removed;
  a.report.vertices_moved += again.vertices_moved;
  a.report.faces_added += again.faces_added;
  a.report.faces_removed += again.faces_removed;
  return true;
}

void look(Attempt& a, Context& context) {
  a.left = surface_contacts(a.soup.points, a.soup.triangles, context);
  a.touching = touching_vertices(a.soup, &context).size();
}

/// @param finest of the grid, see `GridFrame`
/// @param floats whether the result is rounded to single precision
Attempt attempt(const Soup& soup, const MakeSolidOptions& options, int finest, bool floats, bool tell_progress,
                Context& context) {
  Attempt a{soup, {.operation = "make-solid"}, {}, 0, {}};
  a.left = SolidFromSoup(a.soup, options.max_deviation, options.keep_walls, finest, floats, false, a.fillings)
               .run(a.report, tell_progress, context);
  // What the rounding of new vertices made cross is cut again.
  for (int pass = 1; pass < solid_passes && !a.left.none(); ++pass)
    if (!go_on(a, options, finest, floats, context)) break;
  if (floats) {
    round_points(a.soup, a.report, context);
    turn_outward(a.soup, a.report, context);
  }
  if (floats || !a.left.none()) look(a, context);
  return a;
}

/// What rounding to floats made cross or touch is found where everything lies on their grid.
Attempt attempt_with_floats(const Soup& soup, const Soup& as_floats, const MakeSolidOptions& options,
                            Context& context) {
  Attempt best = attempt(soup, options, GridFrame::doubles, true, true, context);
  if (best.clean()) return best;
  Attempt coarse = attempt(as_floats, options, GridFrame::floats, true, false, context);
  if (coarse.better_than(best)) best = std::move(coarse);
  for (int pass = 1; pass < solid_passes && !best.clean(); ++pass) {
    Attempt next = best;
    if (!go_on(next, options, GridFrame::floats, true, context)) break;
    round_points(next.soup, next.report, context);
    turn_outward(next.soup, next.report, context);
    look(next, context);
    if (!next.better_than(best)) break;
    best = std::move(next);
  }
  if (best.touching == 0) return best;
  Attempt parted = best;
  part_touching_vertices(parted.soup, parted_share * options.max_deviation * soup_diagonal(soup), parted.report,
                         context);
  look(parted, context);
  return parted.better_than(best) ? parted : best;
}

}  // namespace

const OptionSchema& MakeSolidOptions::schema() {
  using O = MakeSolidOptions;
  static const OptionSchema schema =
      Schema<O>()
          .number("max-deviation", &O::max_deviation,
                  {.unit = "of the diagonal",
                   .min = 0,
                   .max = 0.1,
                   .help = "walls and sheets nearer than this to what stays go"})
          .boolean("keep-walls", &O::keep_walls, {.help = "other walls and sheets stay, as thin gaps and plates"})
          .boolean("single-precision", &O::single_precision,
                   {.help = "the result stays a solid in a file that holds floats and no indices (STL)"});
  return schema;
}

Report make_solid(Soup& soup, const MakeSolidOptions& options, Context& context) {
  std::vector<std::uint32_t> fillings;
  return make_solid_naming_fillings(soup, options, fillings, context);
}

Report make_solid_naming_fillings(Soup& soup, const MakeSolidOptions& options, std::vector<std::uint32_t>& fillings,
                                  Context& context) {
  fillings.clear();
  validate(options);
  check_soup(soup, &context);
  context.checkpoint();
  Report report;
  report.operation = "make-solid";
  Soup as_floats = soup;
  if (options.single_precision) round_points(as_floats, report, context);
  if (is_clean_solid(as_floats, options.single_precision, context)) {
    if (!report.unchanged()) soup = std::move(as_floats);
    context.progress("make-solid", 1);
    return report;
  }
  Attempt best = options.single_precision ? attempt_with_floats(soup, as_floats, options, context)
                                          : attempt(soup, options, GridFrame::doubles, false, true, context);
  report = std::move(best.report);
  tell_what_is_left(best.soup, best.left, options.single_precision, report, context);
  if (!report.unchanged()) {
    soup = std::move(best.soup);
    fillings = std::move(best.fillings);
  }
  context.progress("make-solid", 1);
  return report;
}

}  // namespace tri
