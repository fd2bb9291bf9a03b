#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "mesh_check.hpp"
#include "meshops/error.hpp"
#include "meshops/operators/compact.hpp"
#include "meshops/registry.hpp"

using namespace tri;
using namespace tri::test;

namespace {

struct ShiftOptions {
  double x = 1;

  static const OptionSchema& schema() {
    static const OptionSchema schema =
        Schema<ShiftOptions>().number("x", &ShiftOptions::x, {.unit = "mm", .help = "by"});
    return schema;
  }
};

Report shift(Soup& soup, const ShiftOptions& options, Context&) {
  validate(options);
  for (Vec3& p : soup.points) p[0] += options.x;
  Report report;
  report.vertices_moved = soup.points.size();
  return report;
}

}  // namespace

TEST_CASE("registry: every operator of the standard list can be found by its name and says what it does") {
  const Registry& registry = Registry::standard();
  std::set<std::string> names;
  for (const auto& op : registry.operators()) {
    CAPTURE(op->name());
    CHECK(names.insert(op->name()).second);
    CHECK(registry.find(op->name()) == op.get());
    CHECK_FALSE(op->summary().empty());
    for (const auto& entry : op->schema().entries()) {
      CAPTURE(entry.info.name);
      CHECK_FALSE(entry.info.help.empty());
      CHECK(entry.info.help.find('\n') == std::string::npos);
      CHECK(entry.info.help.back() != '.');
    }
  }
  for (const char* name : {"build-mesh", "to-soup", "compact"}) CHECK(names.contains(name));
  const Json description = registry.describe();
  CHECK(description.size() == names.size());
  CHECK(description[0]["domain"] == "soup");
  CHECK(description[0]["result"] == "mesh");
}

TEST_CASE("registry: name and time of a report are filled for every operator") {
  Mesh mesh = grid(2, 2);
  const Operator& op = Registry::standard().at("compact");
  Context context;
  const CompactOptions options;
  const Report report = op.run(view_of(mesh), &options, context);
  CHECK(report.operation == "compact");
  CHECK(report.seconds >= 0);
  CHECK(to_json(report)["operation"] == "compact");
  CHECK_FALSE(to_json(report).contains("faces_removed"));
}

TEST_CASE("registry: operators on soups, and a domain that does not fit") {
  Registry registry;
  registry.add("shift", shift, "Moves points along x");
  const Operator& op = registry.at("shift");
  Soup soup{.points = {{0, 0, 0}}};
  ShiftOptions options{.x = 2.5};
  Context context;
  CHECK(op.run(soup, &options, context).operation == "shift");
  CHECK(soup.points[0] == Vec3(2.5, 0, 0));
  PointSet points;
  CHECK_THROWS_AS(op.run(points, &options, context), InvalidInput);
  Mesh mesh = grid(1, 1);
  CHECK_THROWS_AS(Registry::standard().at("to-soup").run(view_of(mesh), nullptr, context), InvalidInput);
  const CompactOptions compact_options;
  CHECK_THROWS_AS(Registry::standard().at("compact").run(soup, &compact_options, context), InvalidInput);
}

TEST_CASE("registry: unknown, ill-formed and taken names are refused") {
  Registry registry;
  registry.add("shift", shift, "Moves points along x");
  CHECK_THROWS_AS(registry.add("shift", shift, "again"), InvalidInput);
  CHECK_THROWS_AS(registry.add("Shift", shift, "not kebab-case"), InvalidInput);
  CHECK(registry.find("compact") == nullptr);
  try {
    registry.at("shiftt");
    FAIL("found");
  } catch (const InvalidInput& error) {
    CHECK(std::string(error.what()) == "unknown operator shiftt; allowed: shift");
  }
}
