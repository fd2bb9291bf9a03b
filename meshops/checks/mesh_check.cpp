#include "meshops/checks/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "meshops/checks/shells.hpp"
#include "meshops/crossings/predicates.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/joining/joined_points.hpp"
#include "meshops/soup_edit.hpp"

namespace tri {
namespace {

/// Whether two sorted lists of corners come from triangles that face the same way.
void judge_shapes(const Soup& soup, double needle, MeshCheck& check) {
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    const Triangle& t = soup.triangles[i];
    const Vec3 &a = soup.points[t[0]], &b = soup.points[t[1]], &c = soup.points[t[2]];
    const double longest = std::max({(b - a).sqrnorm(), (c - b).sqrnorm(), (a - c).sqrnorm()});
    const double area = area_vector(soup, t).norm();
    if (area > 1e-12 * longest && area >= needle * longest) continue;
    if (repeats_vertex(t) || (area <= 1e-12 * longest && collinear_exact(a, b, c)))
      check.degenerate.push_back(i);
    else if (area < needle * longest)
      check.needles.push_back(i);
  }
}

void count_opposites(const Soup& soup, MeshCheck& check) {
  if (check.places.duplicate_triangles.empty()) return;
  std::map<Triangle, bool> first;
  std::vector<char> later(soup.triangles.size(), 0);
  const auto sorted = [&](std::uint32_t i) {
    Triangle t = soup.triangles[i];
    std::sort(t.begin(), t.end());
    return t;
  };
  for (const std::uint32_t i : check.places.duplicate_triangles) {
    later[i] = 1;
    first.emplace(sorted(i), false);
  }
  for (std::uint32_t i = 0; i < soup.triangles.size(); ++i) {
    if (later[i]) continue;
    if (const auto found = first.find(sorted(i)); found != first.end()) found->second = is_even(soup.triangles[i]);
  }
  for (const std::uint32_t i : check.places.duplicate_triangles)
    check.opposite_duplicates +=
        !repeats_vertex(soup.triangles[i]) && first.at(sorted(i)) != is_even(soup.triangles[i]);
}

void judge_shells(const Soup& soup, MeshCheck& check, Context& context) {
  Shells shells = find_shells(soup, context);
  find_depths(soup, shells, context);
  for (const Shell& s : shells.shells)
    if (s.closed && s.reversed == 0) {
      if (is_inside_out(s))
        check.inside_out.push_back(s.triangles[0]);
      else if (s.volume > 0 && s.winding > 0)
        check.nested_solids.push_back(s.triangles[0]);
    }
  check.components = measure_components(soup, check.places.component_of_triangle, shells);
}

void find_coincident(const Soup& soup, bool with_intersections, MeshCheck& check, Context& context) {
  const std::vector<std::uint32_t> same = points_at_same_place(soup.points, &context);
  for (std::uint32_t i = 0; i < same.size(); ++i)
    if (same[i] != i) check.coincident_vertices.push_back({same[i], i});
  if (!check.coincident_vertices.empty())
    check.open_seams = join_points(soup, same, {.join_crowds = true}, context).edges_joined;
  context.checkpoint();
  if (!with_intersections) return;
  std::vector<Triangle> welded = soup.triangles;
  for (Triangle& t : welded) t = {same[t[0]], same[t[1]], same[t[2]]};
  check.self_intersections = self_intersections(soup.points, welded, context, Neighbors::judge);
}

}  // namespace

const char* to_string(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::solid:
      return "solid";
    case SurfaceKind::watertight:
      return "watertight";
    case SurfaceKind::open_surface:
      return "open surface";
    case SurfaceKind::none:
      break;
  }
  return "no surface";
}

std::vector<std::pair<const char*, std::uint64_t>> MeshCheck::defects(bool boundary_is_wrong) const {
  std::vector<std::pair<const char*, std::uint64_t>> result;
  const auto add = [&](const char* name, std::uint64_t count) {
    if (count > 0) result.emplace_back(name, count);
  };
  if (boundary_is_wrong) add("boundary loops", summary.boundary_loops);
  add("non-manifold edges", summary.nonmanifold_edges);
  add("non-manifold vertices", summary.nonmanifold_vertices);
  add("edges whose triangles run the same way", summary.misoriented_edges);
  add("shells inside out", inside_out.size());
  add("degenerate triangles", degenerate.size());
  add("duplicate triangles", places.duplicate_triangles.size());
  add("unreferenced vertices", summary.unused_vertices);
  add("unwelded seam edges", open_seams);
  add("T-junctions", t_junctions.size());
  add("self-intersections", self_intersections.size());
  return result;
}

MeshCheck check_mesh(const Soup& soup, const MeshCheckOptions& options, Context& context) {
  check_soup(soup, &context);
  context.checkpoint();
  context.progress("check", 0);
  MeshCheck check;
  check.summary = summarize(soup, &check.places, &context);
  context.checkpoint();
  context.progress("check", 0.3);
  judge_shapes(soup, options.needle, check);
  count_opposites(soup, check);
  judge_shells(soup, check, context);
  context.progress("check", 0.5);
  check.t_junctions = find_t_junctions(soup, length_tolerance(soup, 0, options.t_junction_tolerance), context);
  context.progress("check", 0.6);
  find_coincident(soup, options.self_intersections, check, context);
  const MeshSummary& s = check.summary;
  check.watertight = s.triangles > s.repeated_corners && s.boundary_edges == 0 && s.nonmanifold_edges == 0 &&
                     s.nonmanifold_vertices == 0 && s.misoriented_edges == 0;
  if (s.area > 0)
    check.kind = !check.watertight          ? SurfaceKind::open_surface
                 : check.inside_out.empty() ? SurfaceKind::solid
                                            : SurfaceKind::watertight;
  context.progress("check", 1);
  return check;
}

nlohmann::ordered_json to_json(const MeshCheck& check, std::size_t most) {
  using Json = nlohmann::ordered_json;
  const MeshSummary& s = check.summary;
  Json json;
  json["verdict"] = to_string(check.kind);
  json["watertight"] = check.watertight;
  json["solid"] = check.kind == SurfaceKind::solid;
  json["manifold"] = s.manifold;
  json["oriented"] = s.oriented;
  json["closed"] = s.closed;
  json["counts"] = {{"vertices", s.vertices},
                    {"triangles", s.triangles},
                    {"edges", s.edges},
                    {"components", s.components},
                    {"boundary_loops", s.boundary_loops},
                    {"boundary_edges", s.boundary_edges},
                    {"nonmanifold_edges", s.nonmanifold_edges},
                    {"nonmanifold_vertices", s.nonmanifold_vertices},
                    {"misoriented_edges", s.misoriented_edges},
                    {"inside_out", check.inside_out.size()},
                    {"nested_solids", check.nested_solids.size()},
                    {"degenerate", check.degenerate.size()},
                    {"needles", check.needles.size()},
                    {"duplicates", check.places.duplicate_triangles.size()},
                    {"opposite_duplicates", check.opposite_duplicates},
                    {"unreferenced_vertices", s.unused_vertices},
                    {"coincident_vertices", check.coincident_vertices.size()},
                    {"open_seams", check.open_seams},
                    {"t_junctions", check.t_junctions.size()},
                    {"self_intersections", check.self_intersections.size()}};
  json["area"] = s.area;
  json["volume"] = check.watertight ? Json(s.volume) : Json();
  json["euler"] = s.euler;
  json["defects"] = Json::object();
  for (const auto& [name, count] : check.defects(true)) json["defects"][name] = count;
  Json& places = json["places"] = Json::object();
  const auto list = [&](const char* name, const auto& items, const auto& element) {
    if (items.empty()) return;
    Json array = Json::array();
    for (std::size_t i = 0; i < std::min(most, items.size()); ++i) array.push_back(element(items[i]));
    places[name] = std::move(array);
    if (items.size() > most) places[std::string(name) + "_more"] = items.size() - most;
  };
  const auto itself = [](const auto& item) { return Json(item); };
  list("boundary_loops", check.places.boundary_loops, itself);
  list("nonmanifold_edges", check.places.nonmanifold_edges, itself);
  list("nonmanifold_vertices", check.places.nonmanifold_vertices, itself);
  list("misoriented_edges", check.places.misoriented_edges, itself);
  list("inside_out", check.inside_out, itself);
  list("nested_solids", check.nested_solids, itself);
  list("degenerate", check.degenerate, itself);
  list("needles", check.needles, itself);
  list("duplicates", check.places.duplicate_triangles, itself);
  list("unreferenced_vertices", check.places.unused_vertices, itself);
  list("coincident_vertices", check.coincident_vertices, itself);
  list("t_junctions", check.t_junctions, [](const TJunction& j) {
    return Json{{"triangle", j.triangle}, {"side", j.side}, {"vertex", j.vertex}, {"share", j.share}};
  });
  list("self_intersections", check.self_intersections, itself);
  json["components"] = Json::array();
  for (std::size_t i = 0; i < std::min(most, check.components.size()); ++i) {
    const SoupComponent& c = check.components[i];
    json["components"].push_back({{"triangles", c.triangles},
                                  {"area", c.area},
                                  {"closed", c.closed},
                                  {"volume", c.closed ? Json(c.volume) : Json()}});
  }
  if (check.components.size() > most) json["components_more"] = check.components.size() - most;
  return json;
}

}  // namespace tri
