// Runs the commands of the program that need a CAD model.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;

namespace {

long lines_in(const std::string& path) {
  const std::string bytes = file_bytes(path);
  return std::count(bytes.begin(), bytes.end(), '\n');
}

}  // namespace

TEST_CASE("tri model: lists its parts and writes one as IGES and as STEP with the same faces") {
  const TemporaryFolder folder;
  const json parts = parsed(run_tri({"model", "--json"}, folder.path()));
  std::vector<std::string> names;
  for (const json& part : parts) names.push_back(part["name"]);
  for (const char* name : {"boot-lid", "blade", "bracket", "elbow", "housing", "sphere-cap", "fillet-block"})
    CHECK(std::count(names.begin(), names.end(), name) == 1);
  for (const char* file : {"elbow.igs", "elbow.step"}) {
    CAPTURE(file);
    CHECK(run_tri({"model", "elbow", "-o", file}, folder.path()).exit_code == 0);
    const json info = parsed(run_tri({"info", file, "--json"}, folder.path()));
    const json part = *std::find_if(parts.begin(), parts.end(), [](const json& p) { return p["name"] == "elbow"; });
    CHECK(info["kind"] == "cad");
    CHECK(info["components"] == part["components"]);
    CHECK(info["boundary_loops"] == part["loops"]);
    CHECK(info["euler"] == part["euler"]);
    CHECK(info["unusable_faces"].empty());
    CHECK(contains(run_tri({"info", file}, folder.path()).out, "Euler"));
  }
}

TEST_CASE("tri model: an unknown part or ending is refused with 2, naming those that there are") {
  const TemporaryFolder folder;
  const Outcome part = run_tri({"model", "boot-lit", "-o", "a.igs"}, folder.path());
  CHECK(part.exit_code == 2);
  CHECK(contains(part.err, "boot-lid"));
  const Outcome ending = run_tri({"model", "elbow", "-o", "a.dwg"}, folder.path());
  CHECK(ending.exit_code == 2);
  CHECK(contains(ending.err, ".step"));
  CHECK(folder.entries().empty());
}

TEST_CASE("tri sample: makes as many points as asked, with the truth beside them, the same for the same seed") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  const auto sample = [&](const char* output, const char* seed) {
    return parsed(run_tri({"sample", "--cad", "cap.step", "-n", "500", "--noise", "0.01", "--outliers", "0.1", "--seed",
                           seed, "-o", output, "--json"},
                          folder.path()));
  };
  const json made = sample("a.xyz", "5");
  CHECK(made["points"] == 500);
  CHECK(lines_in(folder / "a.xyz") == 500);
  CHECK(lines_in(folder / "a.truth.csv") == 501);
  sample("b.xyz", "5");
  sample("c.xyz", "6");
  CHECK(file_bytes(folder / "a.xyz") == file_bytes(folder / "b.xyz"));
  CHECK(file_bytes(folder / "a.xyz") != file_bytes(folder / "c.xyz"));
  const json info = parsed(run_tri({"info", "a.xyz", "--json"}, folder.path()));
  CHECK(info["kind"] == "points");
  CHECK(info["points"] == 500);
  CHECK(info["spacing"]["median"].get<double>() > 0);
}

TEST_CASE("tri sample: wrong options are refused with 2 and leave nothing") {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{{"--points", "0"},
                                                                                    {"--noise", "-1"},
                                                                                    {"--outliers", "2"},
                                                                                    {"--pattern", "spiral"},
                                                                                    {"--drop-outs", "2"},
                                                                                    {"--view", "0,0,0"}}) {
    std::vector<std::string> arguments{"sample", "--cad", "missing.step", "-o", "a.xyz"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_tri(arguments, folder.path());
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(contains(outcome.err, more[0]));
  }
  CHECK(run_tri({"sample", "--cad", "missing.step", "-o", "a.xyz"}, folder.path()).exit_code == 3);
  CHECK(run_tri({"sample", "--cad", "missing.step", "-o", "a.dat"}, folder.path()).exit_code == 2);
  CHECK(folder.entries().empty());
}

TEST_CASE("tri: a CAD file that holds nothing usable is refused with 3") {
  const TemporaryFolder folder;
  folder.make("empty.step", "");
  folder.make("garbage.igs", std::string(3000, '\xd0'));
  folder.make("hollow.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n");
  const auto before = folder.entries().size();
  for (const char* file : {"empty.step", "garbage.igs", "hollow.step", "missing.igs"}) {
    CAPTURE(file);
    const Outcome info = run_tri({"info", file}, folder.path());
    CHECK(info.exit_code == 3);
    CHECK(contains(info.err, file));
    CHECK(info.out.empty());
    CHECK(run_tri({"sample", "--cad", file, "-o", "a.xyz"}, folder.path()).exit_code == 3);
  }
  CHECK(folder.entries().size() == before);
}

TEST_CASE("tri: an interrupt ends a command with 130 and without output") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  // So many points take far longer than the interrupt.
  const Outcome outcome =
      run_tri({"sample", "--cad", "cap.step", "-n", "3000000", "-o", "a.xyz"}, folder.path(), "", 400);
  CHECK(outcome.exit_code == 130);
  CHECK(folder.entries() == std::vector<std::string>{"cap.step"});
}

namespace {

// A part and 1500 points on it.
void make_measurement(const TemporaryFolder& folder) {
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  REQUIRE(
      run_tri({"sample", "--cad", "cap.step", "-n", "1500", "--no-truth", "-o", "cap.xyz"}, folder.path()).exit_code ==
      0);
}

}  // namespace

TEST_CASE("tri: an interrupt ends a command that waits for its CAD file, which no reader hands back") {
  const TemporaryFolder folder;
  REQUIRE(mkfifo((folder / "part.step").c_str(), 0600) == 0);
  const auto before = folder.entries();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"info", "part.step"}, {"sample", "--cad", "part.step", "-n", "9", "-o", "a.xyz"}}) {
    const Outcome outcome = run_tri(words, folder.path(), "", 300);
    CHECK(outcome.exit_code == 130);
    CHECK(contains(outcome.err, "interrupted"));
    CHECK(folder.entries() == before);
  }
}

TEST_CASE(
    "tri triangulate: every point becomes a vertex of one mesh with the model's topology, and the report says so") {
  const TemporaryFolder folder;
  make_measurement(folder);
  const Outcome outcome = run_tri(
      {"triangulate", "--cad", "cap.step", "cap.xyz", "-o", "cap.ply", "--report", "report.json"}, folder.path());
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.err.empty());  // no progress, as this is no terminal
  const json report = json::parse(file_bytes(folder / "report.json"));
  for (const char* key : {"points", "outliers", "faces", "unmeasured_faces", "holes", "unusable_faces", "topology",
                          "method", "seconds", "version", "options"})
    CHECK_MESSAGE(report.contains(key), key);
  for (const char* key : {"model", "mesh"})
    for (const char* number : {"components", "loops", "euler"}) CHECK(report["topology"][key].contains(number));
  CHECK(report["points"] == 1500);
  CHECK(report["faces"].size() == 1);
  CHECK(report["faces"][0]["points"] == 1500);
  CHECK(report["outliers"].empty());
  const json info = parsed(run_tri({"info", "cap.ply", "--json"}, folder.path()));
  CHECK(info["vertices"] == 1500);
  CHECK(info["unused_vertices"] == 0);
  CHECK(info["components"] == 1);
  CHECK(info["boundary_loops"] == 1);
  CHECK(info["euler"] == 1);
  CHECK((info["manifold"] == true && info["oriented"] == true));
  for (const char* property : {"point_index", "cad_face", "u", "v", "deviation"})
    CHECK_MESSAGE(std::count(info["vertex_properties"].begin(), info["vertex_properties"].end(), property) == 1,
                  property);
}

TEST_CASE("tri triangulate: wrong usage is refused with 2 before any file is opened") {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{{"--method", "magic"},
                                                                                    {"--unmeasured", "maybe"},
                                                                                    {"--hole-size", "0"},
                                                                                    {"--hole-size", "inf"},
                                                                                    {"--noise", "-1"},
                                                                                    {"--patches", "a.what"},
                                                                                    {"--reprot", "a.json"}}) {
    std::vector<std::string> arguments{"triangulate", "--cad", "missing.step", "missing.xyz", "-o", "a.ply"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_tri(arguments, folder.path());
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
  CHECK(run_tri({"triangulate", "missing.xyz", "-o", "a.ply"}, folder.path()).exit_code == 2);
  CHECK(folder.entries().empty());
}

TEST_CASE("tri triangulate: bad points are refused with the documented code and leave no output") {
  const TemporaryFolder folder;
  make_measurement(folder);
  folder.make("empty.xyz", "");
  folder.make("garbage.xyz", std::string(4000, '\xb1'));
  folder.make("nan.xyz", "0 0 0\n1 nan 0\n0 1 0\n1 1 0\n");
  folder.make("infinite.xyz", "0 0 0\n1 inf 0\n0 1 0\n1 1 0\n");
  folder.make("two.xyz", "0 0 1\n1 0 1\n");
  folder.make("truncated.ply",
              "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\n"
              "end_header\n0 0 0\n");
  std::string far, equal;
  for (int i = 0; i < 50; ++i) {
    far += std::to_string(10000 + i % 7) + " " + std::to_string(i % 5) + " " + std::to_string(i % 3) + "\n";
    equal += "0 0 1\n";
  }
  folder.make("far.xyz", far);
  folder.make("equal.xyz", equal);
  const auto before = folder.entries().size();
  for (const auto& [points, code] : std::vector<std::pair<const char*, int>>{{"missing.xyz", 3},
                                                                             {"empty.xyz", 3},
                                                                             {"garbage.xyz", 3},
                                                                             {"nan.xyz", 3},
                                                                             {"infinite.xyz", 3},
                                                                             {"truncated.ply", 3},
                                                                             {"two.xyz", 1},
                                                                             {"far.xyz", 1},
                                                                             {"equal.xyz", 1}}) {
    CAPTURE(points);
    const Outcome outcome =
        run_tri({"triangulate", "--cad", "cap.step", points, "-o", "a.ply", "--report", "a.json"}, folder.path());
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == code);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.starts_with("tri: "));
    CHECK(folder.entries().size() == before);
  }
  for (const char* output : {"missing/a.ply", "/dev/null/a.ply"})
    CHECK(run_tri({"triangulate", "--cad", "cap.step", "cap.xyz", "-o", output}, folder.path()).exit_code == 3);
  CHECK(folder.entries().size() == before);
}
