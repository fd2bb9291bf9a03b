#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "mesh_check.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/compact.hpp"
#include "meshops/operators/thin.hpp"
#include "meshops/pipeline.hpp"
#include "meshops/to_soup.hpp"

using namespace tri;
using namespace tri::test;

namespace {

struct NudgeOptions {
  double by = 1;
  int times = 1;
  bool twice = true;
  std::string label;

  static const OptionSchema& schema() {
    using O = NudgeOptions;
    static const OptionSchema schema = Schema<O>()
                                           .number("by", &O::by, {.unit = "mm", .min = -10, .max = 10, .help = "step"})
                                           .integer("times", &O::times, {.min = 1, .max = 9, .help = "steps"})
                                           .boolean("twice", &O::twice, {.help = "and again"})
                                           .text("label", &O::label, {.help = "any text"});
    return schema;
  }
};

Report nudge(Soup& soup, const NudgeOptions& options, Context&) {
  validate(options);
  for (Vec3& p : soup.points) p[2] += options.by * options.times;
  Report report;
  report.vertices_moved = soup.points.size();
  return report;
}

Report refuse(MeshView, const NudgeOptions&, Context&) {
  throw InvalidInput("no");
}

const Registry& registry() {
  static const Registry r = [] {
    Registry made;
    register_operators(made);
    made.add("nudge", nudge, "Moves points along z");
    made.add("refuse", refuse, "Always throws");
    return made;
  }();
  return r;
}

std::string message(const std::function<void()>& run) {
  try {
    run();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

std::string json_message(const std::string& text) {
  return message([&] { Pipeline::from_json(text, registry()); });
}

std::string tokens_message(const std::vector<std::string>& tokens) {
  return message([&] { Pipeline::from_tokens(tokens, registry()); });
}

bool names(const std::string& text, std::string_view part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("pipeline: C++, command line and JSON say the same and come back") {
  Pipeline made(registry());
  made.add(nudge, {.by = -2.5, .times = 3, .twice = false, .label = "a b"})
      .add(compact)
      .add(compact, {.isolated_vertices = true});
  const std::vector<std::string> tokens = {
      "nudge", "--by", "-2.5",    "--times", "3",       "--no-twice",         "--label",
      "a b",   "!",    "compact", "!",       "compact", "--isolated-vertices"};
  const std::string json = R"({"version":1,"steps":[{"op":"nudge","by":-2.5,"times":3,"twice":false,"label":"a b"},)"
                           R"({"op":"compact"},{"op":"compact","isolated-vertices":true}]})";
  CHECK(made.to_tokens() == tokens);
  CHECK(made.to_json().dump() == json);
  const Pipeline read = Pipeline::from_tokens(tokens, registry()), parsed = Pipeline::from_json(json, registry());
  CHECK(read.to_json().dump() == json);
  CHECK(parsed.to_tokens() == tokens);
  const auto* options = static_cast<const NudgeOptions*>(parsed.steps()[0].options.get());
  CHECK(options->by == -2.5);
  CHECK(options->label == "a b");
}

TEST_CASE("pipeline: options may be joined by =, and a value may be a lone exclamation mark") {
  const std::vector<std::string> tokens = {"nudge", "--by=2", "--twice=false", "--label=!"};
  const Pipeline pipeline = Pipeline::from_tokens(tokens, registry());
  CHECK(pipeline.to_json()["steps"][0] == Json{{"op", "nudge"}, {"by", 2.0}, {"twice", false}, {"label", "!"}});
  CHECK(Pipeline::from_tokens(pipeline.to_tokens(), registry()).to_json() == pipeline.to_json());
}

TEST_CASE("pipeline: a wrong command line names step, key, value and what is allowed") {
  CHECK(tokens_message({}).empty());
  CHECK(names(tokens_message({"nudge", "--by", "11"}),
              "step 1 (nudge): option by = 11 is not allowed; allowed: a number from -10 to 10 (mm)"));
  CHECK(names(tokens_message({"compact", "!", "nudge", "--bye", "1"}),
              "step 2 (nudge): unknown option bye; allowed: by, times"));
  CHECK(names(tokens_message({"nudge", "--by"}), "by has no value"));
  CHECK(names(tokens_message({"nudge", "--by", "1", "--by=2"}), "given twice"));
  CHECK(names(tokens_message({"nudge", "--twice", "--no-twice"}), "given twice"));
  CHECK(names(tokens_message({"nudge", "in.stl"}), "unexpected 'in.stl'"));
  CHECK(names(tokens_message({"nudge", "--"}), "unexpected '--'"));
  CHECK(names(tokens_message({"nudge", "--no-by"}), "unknown option no-by"));
  CHECK(names(tokens_message({"nudg"}), "step 1: unknown operator nudg; allowed: "));
  CHECK(names(tokens_message({"!", "compact"}), "step 1: no operator before !"));
  CHECK(names(tokens_message({"compact", "!"}), "step 2: no operator after !"));
  CHECK(names(tokens_message({"compact", "!", "!", "compact"}), "step 2: no operator before !"));
}

TEST_CASE("pipeline: wrong JSON is refused with its place") {
  CHECK(names(json_message("{"), "byte"));
  CHECK(names(json_message("[]"), "object"));
  CHECK(names(json_message("{}"), "version"));
  CHECK(names(json_message(R"({"version":2,"steps":[]})"), "version = 2 is not allowed; allowed: 1"));
  CHECK(names(json_message(R"({"version":1})"), "steps"));
  CHECK(names(json_message(R"({"version":1,"steps":[],"name":"x"})"), "unknown key name"));
  CHECK(names(json_message(R"({"version":1,"steps":[{"by":1}]})"), "step 1"));
  CHECK(names(json_message(R"({"version":1,"steps":[{"op":"nudge","by":"1"}]})"), "step 1 (nudge): option by = \"1\""));
  CHECK(names(json_message(R"({"version":1,"steps":[{"op":"nudge","by":1,"by":2}]})"), "key by is there twice"));
  CHECK(json_message(R"({"version":1,"steps":[]})").empty());
}

TEST_CASE("pipeline: an option out of range or a foreign function is refused when it is added") {
  Pipeline pipeline(registry());
  CHECK_THROWS_AS(pipeline.add(nudge, {.times = 10}), InvalidInput);
  CHECK(pipeline.empty());
  Pipeline standard;
  CHECK(names(message([&] { standard.add(nudge); }), "not a registered operator"));
}

TEST_CASE("pipeline: a conversion that was left out is inserted and reported") {
  Mesh source = grid(2, 2);
  source.delete_face(FaceHandle(0), false);
  Geometry geometry = to_soup(view_of(source));
  Pipeline pipeline(registry());
  pipeline.add(nudge).add(compact).add(nudge, {.by = 2});
  Domain result = Domain::mesh;
  const auto plan = pipeline.plan(Domain::soup, &result);
  REQUIRE(plan.size() == 5);
  CHECK(result == Domain::soup);
  CHECK(plan[1].inserted);
  CHECK(plan[1].op->name() == "build-mesh");
  CHECK(plan[3].op->name() == "to-soup");

  Context context;
  const std::vector<Report> reports = pipeline.run(geometry, context);
  REQUIRE(reports.size() == 5);
  CHECK(reports[1].operation == "build-mesh");
  CHECK(reports[1].notes.front() == "inserted before compact, which works on a mesh");
  REQUIRE(std::holds_alternative<Soup>(geometry));
  CHECK(std::get<Soup>(geometry).points[0] == Vec3(0, 0, 3));
  CHECK(std::get<Soup>(geometry).triangles.size() == 7);

  // Said by the user, it is an ordinary step.
  Pipeline said(registry());
  said.add("build-mesh").add(compact);
  CHECK(said.plan(Domain::soup).size() == 2);
  said.run(geometry, context);
  CHECK(std::holds_alternative<Mesh>(geometry));
}

TEST_CASE("pipeline: on a mesh in place, a step that changes the type is refused before anything runs") {
  Mesh mesh = grid(2, 2);
  mesh.delete_face(FaceHandle(0), false);
  const Snapshot before = snapshot(view_of(mesh));
  Context context;
  Pipeline pipeline(registry());
  pipeline.add(compact).add("to-soup");
  CHECK(names(message([&] { pipeline.run(view_of(mesh), context); }), "step 2 (to-soup)"));
  CHECK(snapshot(view_of(mesh)) == before);
  Pipeline fine(registry());
  CHECK(fine.add(compact).run(view_of(mesh), context).at(0).faces_removed == 1);
}

TEST_CASE("pipeline: a failing step is named, cancel stops before the next change") {
  Mesh mesh = grid(1, 1);
  Context context;
  Pipeline pipeline(registry());
  pipeline.add(compact).add(refuse);
  CHECK(message([&] { pipeline.run(view_of(mesh), context); }) == "step 2 (refuse): no");
  context.cancel();
  CHECK_THROWS_AS(pipeline.run(view_of(mesh), context), Cancelled);
}

TEST_CASE("pipeline: points stay points; what would connect them is refused before anything runs") {
  PointSet set;
  for (int i = 0; i < 10; ++i) set.points.emplace_back(0.25 * i, 0, 0);
  Pipeline pipeline(registry());
  pipeline.add(thin, {.voxel = 1}).add("remove-outliers");
  Domain result = Domain::mesh;
  CHECK(pipeline.plan(Domain::points, &result).size() == 2);
  CHECK(result == Domain::points);
  Geometry geometry = set;
  Context context;
  const std::vector<Report> reports = pipeline.run(geometry, context);
  REQUIRE(reports.size() == 2);
  CHECK(reports[0].operation == "thin");
  CHECK(std::get<PointSet>(geometry).size() == 3);
  CHECK(pipeline.to_tokens() == std::vector<std::string>{"thin", "!", "remove-outliers"});

  Geometry soup = to_soup(view_of(*std::make_unique<Mesh>(grid(2, 2))));
  CHECK(names(message([&] { pipeline.run(soup, context); }), "step 1 (thin): works on points, and this is a soup"));
  CHECK(names(message([&] { pipeline.plan(Domain::mesh); }), "step 1 (thin): works on points, and this is a mesh"));
  for (const char* name : {"fill-holes", "nudge", "build-mesh"}) {
    Pipeline connecting(registry());
    connecting.add("thin").add(name);
    CHECK(names(message([&] { connecting.plan(Domain::points); }), std::string("step 2 (") + name + ")"));
    CHECK(names(message([&] { connecting.plan(Domain::points); }), "needs a model"));
  }
}
