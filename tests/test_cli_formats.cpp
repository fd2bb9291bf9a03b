// Runs the built program as a user would, on the formats of scenes.
#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;

namespace {

const std::string tetrahedron = "OFF\n4 4 0\n0 0 0\n8 0 0\n0 8 0\n0 0 8\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

}  // namespace

TEST_CASE("tri: every command that takes meshes takes 3MF and glTF by their endings") {
  for (const std::string name : {"a.3mf", "a.glb", "a.gltf"}) {
    CAPTURE(name);
    const TemporaryFolder folder;
    folder.make("in.off", tetrahedron);
    const Outcome written = run_tri({"run", "in.off", name}, folder.path());
    if (contains(written.err, "built without 3MF")) continue;
    CAPTURE(written.err);
    REQUIRE(written.exit_code == 0);
    const json info = json::parse(run_tri({"info", name, "--json"}, folder.path()).out);
    CHECK(info["format"] == (name == "a.3mf" ? "3MF" : "glTF"));
    CHECK(info["triangles"] == 4);
    CHECK(info["volume"].get<double>() == 256.0 / 3);
    CHECK(run_tri({"check", name}, folder.path()).exit_code == 0);
    CHECK(run_tri({"repair", name, "-o", "out-" + name}, folder.path()).exit_code == 0);
    CHECK(run_tri({"compare", "in.off", name}, folder.path()).exit_code == 0);
    CHECK(run_tri({"render", name, "-o", "out.png"}, folder.path()).exit_code == 0);
    CHECK(run_tri({"run", name, "back.off"}, folder.path()).exit_code == 0);
    CHECK(file_bytes(folder / "back.off") == tetrahedron);
  }
}

TEST_CASE("tri: VTK PolyData is written, and refused for reading with the reason") {
  const TemporaryFolder folder;
  folder.make("in.off", tetrahedron);
  CHECK(run_tri({"run", "in.off", "out.vtp"}, folder.path()).exit_code == 0);
  const Outcome refused = run_tri({"info", "out.vtp"}, folder.path());
  CHECK(refused.exit_code == 3);
  CHECK(contains(refused.err, "written only"));
}

TEST_CASE("tri: a scene that is damaged, missing or into a folder is refused with 3, in one line that names the file") {
  const TemporaryFolder folder;
  folder.make("bad.glb", "glTF\2");
  folder.make("bad.3mf", "PK\3\4 and no more");
  folder.make("bad.gltf", R"({"asset": {"version": "2.0"}, "nodes": [{"children": [0]}], "scenes": [{"nodes": [0]}]})");
  for (const std::string name : {"bad.glb", "bad.3mf", "bad.gltf", "missing.glb"}) {
    const Outcome outcome = run_tri({"info", name}, folder.path());
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 3);
    CHECK(outcome.err.starts_with("tri: " + name));
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
  folder.make("in.off", tetrahedron);
  const std::vector<std::string> before = folder.entries();
  CHECK(run_tri({"run", "in.off", "no/such/folder/out.glb"}, folder.path()).exit_code == 3);
  CHECK(folder.entries() == before);
}
