#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "io/mesh_file.hpp"
#include "meshops/checks/mesh_check.hpp"

namespace tri::cli {
namespace {

struct CheckArguments {
  std::string input;
  double needle = MeshCheckOptions{}.needle;
  bool json = false, open = false, no_self_intersections = false;
  std::size_t places = 1000;
};

constexpr std::size_t shown = 5;

/// "12, 13, 20 …" of a list, each item by `text`.
template <class Items, class Text>
std::string first_of(const Items& items, const Text& text) {
  std::string line;
  for (std::size_t i = 0; i < std::min(shown, items.size()); ++i) line += (i > 0 ? ", " : "") + text(items[i]);
  return line + (items.size() > shown ? " …" : "");
}

std::string check_text(const MeshCheck& c, const std::vector<std::pair<const char*, std::uint64_t>>& defects) {
  const MeshSummary& s = c.summary;
  std::string text = fmt::format("{}: {} vertices, {} triangles, {} components, area {:.6g}", to_string(c.kind),
                                 with_commas(s.vertices), with_commas(s.triangles), with_commas(s.components), s.area);
  text += c.watertight ? fmt::format(", volume {:.6g}\n", s.volume) : "\n";
  const auto number = [](std::uint32_t i) { return fmt::format("{}", i); };
  const auto pair = [](const std::array<std::uint32_t, 2>& e) { return fmt::format("{}-{}", e[0], e[1]); };
  const auto loop = [](const std::vector<std::uint32_t>& l) {
    return fmt::format("{} edges at vertex {}", l.size(), l.front());
  };
  const auto line = [&](const char* name, std::uint64_t count, const char* what, const std::string& places) {
    if (count > 0) text += fmt::format("  {:<38} {:>9}  {}{}\n", name, with_commas(count), what, places);
  };
  line("boundary loops", s.boundary_loops, "", first_of(c.places.boundary_loops, loop));
  line("non-manifold edges", s.nonmanifold_edges, "vertices ", first_of(c.places.nonmanifold_edges, pair));
  line("non-manifold vertices", s.nonmanifold_vertices, "vertices ", first_of(c.places.nonmanifold_vertices, number));
  line("edges whose triangles run the same way", s.misoriented_edges, "vertices ",
       first_of(c.places.misoriented_edges, pair));
  line("shells inside out", c.inside_out.size(), "with triangle ", first_of(c.inside_out, number));
  line("degenerate triangles", c.degenerate.size(), "triangles ", first_of(c.degenerate, number));
  line("needle triangles (no defect)", c.needles.size(), "triangles ", first_of(c.needles, number));
  line("duplicate triangles", s.duplicate_triangles, "triangles ", first_of(c.places.duplicate_triangles, number));
  line("unreferenced vertices", s.unused_vertices, "vertices ", first_of(c.places.unused_vertices, number));
  line("unwelded seam edges", c.open_seams, "", "");
  line("T-junctions", c.t_junctions.size(), "vertices ",
       first_of(c.t_junctions, [](const TJunction& j) { return fmt::format("{}", j.vertex); }));
  line("self-intersections", c.self_intersections.size(), "triangles ", first_of(c.self_intersections, pair));
  line("solids within solids (no defect)", c.nested_solids.size(), "with triangle ", first_of(c.nested_solids, number));
  line("coincident vertices (no defect)", c.coincident_vertices.size(), "vertices ",
       first_of(c.coincident_vertices, pair));
  return text + (defects.empty() ? "nothing is wrong\n" : "");
}

int run(const CheckArguments& a, Program& program) {
  const Soup soup = read_mesh(a.input, program.context);
  const MeshCheck check =
      check_mesh(soup, {.needle = a.needle, .self_intersections = !a.no_self_intersections}, program.context);
  const auto defects = check.defects(!a.open);
  if (a.json) {
    nlohmann::ordered_json json = to_json(check, a.places);
    json["wrong"] = !defects.empty();
    print_result(json);
  } else {
    print_result(check_text(check, defects));
  }
  return defects.empty() && check.kind != SurfaceKind::none ? exit_done : exit_failed;
}

}  // namespace

void add_check_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("check", "Say what is wrong with a mesh, and where; exit code 1 if anything is");
  const auto a = std::make_shared<CheckArguments>();
  command->add_option("mesh", a->input, "Mesh to read: PLY, STL, OBJ, OFF, 3MF or glTF; - for standard input")
      ->required();
  command->add_flag("--open", a->open, "The mesh is meant to be an open surface: its boundary is nothing wrong");
  command->add_option("--needle", a->needle, "Height over longest side below which a triangle is a needle")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command->add_flag("--no-self-intersections", a->no_self_intersections, "Do not look for triangles that intersect");
  command->add_flag("--json", a->json, "Everything, with lists of places, as JSON on standard output");
  command->add_option("--places", a->places, "How many places of each kind the JSON lists at most")
      ->capture_default_str();
  add_common_options(*command, program);
  command->footer(
      "Wrong are: boundary loops (unless --open), edges of three or more triangles, vertices of several fans, edges whose\n"
      "triangles run the same way, shells inside out, triangles that are degenerate or duplicates, vertices in no triangle,\n"
      "seams that are not welded, T-junctions, and triangles that intersect (decided exactly). Needles, vertices that\n"
      "coincide and solids within solids are listed, but nothing wrong. Indices count from 0 in the order of the file; STL corners with the same\n"
      "coordinates are one vertex.\n\n"
      "Examples:\n"
      "  tri check part.stl\n"
      "  tri check sheet.ply --open --json");
  command->callback([a, &program] { program.action = [a, &program] { return run(*a, program); }; });
}

}  // namespace tri::cli
