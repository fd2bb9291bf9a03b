// Runs `tri ops` and `tri run` with plug-ins.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;

namespace {

const std::string plugins = TRI_TEST_PLUGINS;

const char* const triangle = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0.5\n3 0 1 2\n";

/// Sets TRI_PLUGINS for as long as it lives.
struct Environment {
  explicit Environment(const std::string& value) { setenv("TRI_PLUGINS", value.c_str(), 1); }
  ~Environment() { unsetenv("TRI_PLUGINS"); }
};

}  // namespace

TEST_CASE("tri ops, tri run: operators of plug-ins stand among the others") {
  const TemporaryFolder folder;
  folder.make("in.off", triangle);
  const Outcome ops = run_tri({"ops", "scale", "--plugins", plugins + "/good", "--json"}, folder.path());
  REQUIRE(ops.exit_code == 0);
  CHECK(json::parse(ops.out)["options"][0]["name"] == "factor");
  CHECK(
      contains(run_tri({"ops", "--plugins", plugins + "/good"}, folder.path()).out, "Scales a mesh about the origin"));

  const Outcome run = run_tri({"run", "--plugins", plugins + "/good", "in.off", "!", "scale", "--factor", "2", "!",
                               "out.off", "--save", "r.json"},
                              folder.path());
  CHECK(run.exit_code == 0);
  CHECK(contains(file_bytes(folder / "out.off"), "0 2 1"));

  const Environment environment(plugins + "/good");
  CHECK(contains(run_tri({"ops"}, folder.path()).out, "scale "));
  CHECK(run_tri({"run", "--recipe", "r.json", "in.off", "again.off"}, folder.path()).exit_code == 0);
  CHECK(file_bytes(folder / "again.off") == file_bytes(folder / "out.off"));
}

TEST_CASE("tri run: without its plug-in an operator is unknown, and a plug-in that does not fit is refused") {
  const TemporaryFolder folder;
  folder.make("in.off", triangle);
  CHECK(run_tri({"run", "in.off", "!", "scale", "--factor", "2", "!", "out.off"}, folder.path()).exit_code == 2);

  for (const char* name : {"foreign", "clash"}) {
    CAPTURE(name);
    const Outcome refused =
        run_tri({"run", "--plugins", plugins + "/" + name, "in.off", "!", "compact", "!", "out.off"}, folder.path());
    CHECK(refused.exit_code == (std::string(name) == "foreign" ? 3 : 1));
    CHECK(refused.out.empty());
    CHECK(contains(refused.err, std::string(name) + ".so: "));
  }
  CHECK(run_tri({"ops", "--plugins", "missing"}, folder.path()).exit_code == 3);
  CHECK(folder.entries() == std::vector<std::string>{"in.off"});
}
