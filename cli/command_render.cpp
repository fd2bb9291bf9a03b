#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "cli/commands.hpp"
#include "cli/number_checks.hpp"
#include "cli/points_input.hpp"
#include "io/mesh_file.hpp"
#include "io/pictures/render.hpp"
#include "meshops/points/point_soup.hpp"

namespace tri::cli {
namespace {

struct RenderArguments {
  std::string input, output;
  RenderOptions options;
  PointUnits units;
  std::vector<double> view, up, center;
  std::string size = "1200x900", palette = "auto";
  double range = 0;
  bool json = false;
};

Vec3 to_vec3(const std::vector<double>& v) {
  return {v[0], v[1], v[2]};
}

void parse_size(const std::string& text, RenderOptions& options) {
  int used = 0;
  if (std::sscanf(text.c_str(), "%6dx%6d%n", &options.width, &options.height, &used) != 2 || used != int(text.size()))
    throw UsageError(fmt::format("--size \"{}\" is not WIDTHxHEIGHT, say 1200x900", text));
  for (const int length : {options.width, options.height})
    if (length < 1 || length > 8192) throw UsageError(fmt::format("--size {}: 1 to 8192 pixels each way", text));
}

std::string legend(const Rendering& r, const std::string& by) {
  switch (r.palette) {
    case Palette::categories:
      return fmt::format("{}: {} numbers, one colour each, grey for none\n", by, r.categories);
    case Palette::diverging:
      return fmt::format("{}: blue {:.6g}, white 0, red {:.6g}\n", by, r.low, r.high);
    case Palette::sequential:
      return fmt::format("{}: violet {:.6g} to yellow {:.6g}\n", by, r.low, r.high);
    case Palette::colors:
      return "colours of the file\n";
    case Palette::plain:
      break;
  }
  return "";
}

Soup read_drawable(const RenderArguments& a, Program& program) {
  if (kind_of(a.input) != "points") return read_mesh(a.input, program.context);
  return to_soup(read_points_in_mm(a.input, a.units, program));
}

int run(const RenderArguments& arguments, Program& program) {
  check_output(arguments.output);
  Context& context = program.context;
  const Soup soup = read_drawable(arguments, program);
  const std::string& by = arguments.options.by;
  const bool known = by.empty() || by == "none" || soup.vertex_scalars.contains(by) || soup.face_scalars.contains(by);
  const auto draw = [&] { return render(soup, arguments.options, context); };
  const Rendering r = known ? draw() : usage(draw);
  write_png(arguments.output, r.picture);
  if (arguments.json) {
    print_result(nlohmann::ordered_json{{"picture", arguments.output},
                                        {"width", r.picture.width},
                                        {"height", r.picture.height},
                                        {"palette", name_of(r.palette)},
                                        {"low", r.low},
                                        {"high", r.high},
                                        {"categories", r.categories},
                                        {"covered", r.covered},
                                        {"back", r.back}});
  } else {
    const bool dots = soup.triangles.empty();
    std::string text =
        fmt::format("{}: {} x {} pixels, {} {}\n", arguments.output, r.picture.width, r.picture.height,
                    with_commas(dots ? soup.points.size() : soup.triangles.size()), dots ? "points" : "triangles");
    text += legend(r, arguments.options.by);
    if (r.back > 0) text += fmt::format("{:.1f}% of what is seen are backs of triangles (brown)\n", 100 * r.back);
    print_result(text);
  }
  return exit_done;
}

}  // namespace

void add_render_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("render", "Draw a mesh into a PNG picture; needs no display");
  const auto a = std::make_shared<RenderArguments>();
  command
      ->add_option(
          "mesh", a->input,
          "Mesh: PLY, STL, OBJ, OFF, 3MF or glTF; points (XYZ, CSV, PCD, a PLY without faces) are drawn as dots")
      ->required();
  command->add_option("-o,--output", a->output, "Picture to write, .png")->required();
  command->add_flag("--edges", a->options.edges, "Draw the edges of the triangles, and rims in red");
  command->add_flag("--smooth", a->options.smooth, "Shade smoothly instead of triangle by triangle");
  command->add_option(
      "--by", a->options.by,
      "Colour by this vertex or face property, say cad_face or deviation; \"none\" ignores the file's colours");
  command
      ->add_option("--palette", a->palette,
                   "How --by turns numbers into colours; auto: whole numbers by category, "
                   "numbers of both signs diverging, others sequential")
      ->check(CLI::IsMember({"auto", "categories", "diverging", "sequential"}))
      ->capture_default_str();
  command
      ->add_option("--range", a->range,
                   "Colours end at this value of --by, and at minus it; default: 98% of the values")
      ->check(above_zero());
  const auto vector_option = [&](const char* name, std::vector<double>& target, const char* help) {
    command->add_option(name, target, help)->delimiter(',')->expected(3)->type_name("X,Y,Z");
  };
  vector_option("--view", a->view, "Direction from the part to the camera; default -0.55,-1,0.7");
  vector_option("--up", a->up, "What points upward in the picture; default 0,0,1");
  vector_option("--center", a->center, "Model point in the middle of the picture; default: the part's middle");
  command->add_option("--zoom", a->options.zoom, "1 shows the whole part, 2 half of it")
      ->check(CLI::Range(1e-3, 1e6))
      ->capture_default_str();
  command->add_flag("--perspective", a->options.perspective, "Perspective instead of parallel view");
  command->add_option("--size", a->size, "Pixels, WIDTHxHEIGHT")->capture_default_str();
  add_units_option(*command, a->units);
  command->add_flag("--json", a->json, "Say what was drawn as JSON on standard output");
  add_common_options(*command, program);
  command->footer(
      "Fronts of triangles are bluish, backs are brown, so a patch inside out stands out.\n\n"
      "Examples:\n"
      "  tri render mesh.ply -o mesh.png --edges\n"
      "  tri render mesh.ply -o faces.png --by cad_face --view 0,0,1\n"
      "  tri render mesh.ply -o deviation.png --by deviation --range 0.05 --zoom 4 --center 120,40,0");
  command->callback([a, &program] {
    require_extension(a->output, {"png"}, "the picture");
    parse_size(a->size, a->options);
    if (!a->view.empty()) a->options.view = to_vec3(a->view);
    if (!a->up.empty()) a->options.up = to_vec3(a->up);
    if (!a->center.empty()) a->options.center = to_vec3(a->center);
    if (!(a->options.view.norm() > 0)) throw UsageError("--view 0,0,0 is no direction");
    if (a->range > 0) a->options.range = a->range;
    if (a->palette != "auto") {
      if (a->options.by.empty() || a->options.by == "none") throw UsageError("--palette needs --by");
      a->options.palette = a->palette == "categories"  ? Palette::categories
                           : a->palette == "diverging" ? Palette::diverging
                                                       : Palette::sequential;
    }
    program.action = [a, &program] { return run(*a, program); };
  });
}

}  // namespace tri::cli
