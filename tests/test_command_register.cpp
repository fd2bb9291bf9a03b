// Runs `tri register`.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;

namespace {

// The lines of a CSV file, without the header, as numbers.
std::vector<std::vector<double>> rows_of_file(const std::string& path, const std::string& header) {
  std::istringstream in(file_bytes(path));
  std::string line;
  std::getline(in, line);
  CHECK(line == header);
  std::vector<std::vector<double>> result;
  while (std::getline(in, line)) {
    result.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) result.back().push_back(std::stod(cell));
  }
  return result;
}

const std::string truth_header = "index,face,u,v,x,y,z,nx,ny,nz,outlier";
const std::string header = "index,x,y,z,face,u,v,fx,fy,fz,deviation,on_edge";

}  // namespace

TEST_CASE("tri register: finds the face, the place on it and the closest point that the points were made with") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "bracket", "-o", "part.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "part.step", "-n", "2000", "-o", "scan.xyz"}, folder.path()).exit_code == 0);
  const Outcome outcome =
      run_tri({"register", "--cad", "part.step", "scan.xyz", "-o", "r.csv", "--report", "r.json"}, folder.path());
  CHECK(outcome.exit_code == 0);
  CHECK(contains(outcome.out, "2,000 points"));
  CHECK(outcome.err.empty());
  const auto truth = rows_of_file(folder / "scan.truth.csv", truth_header),
             found = rows_of_file(folder / "r.csv", header);
  REQUIRE(truth.size() == 2000);
  REQUIRE(found.size() == 2000);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto &t = truth[i], &r = found[i];
    REQUIRE(r.size() == 12);
    CHECK(r[0] == static_cast<double>(i));
    for (int k = 0; k < 3; ++k) CHECK(std::abs(r[7 + k] - t[4 + k]) < 1e-8);
    CHECK(std::abs(r[10]) < 1e-8);
    if (r[11] != 0) continue;  // on an edge both faces are right
    CHECK(r[4] == t[1]);
    for (int k = 0; k < 2; ++k) CHECK(std::abs(r[5 + k] - t[2 + k]) < 1e-6);
  }
  const json report = json::parse(file_bytes(folder / "r.json"));
  CHECK(report["points"] == 2000);
  CHECK(report["far"]["points"] == 0);
  CHECK(report["options"]["cad"] == "part.step");
  std::uint64_t on_faces = 0;
  for (const json& face : report["faces"]) on_faces += face["points"].get<std::uint64_t>();
  CHECK(on_faces == 2000);
}

TEST_CASE("tri register: converts units, names points that are far away, and says more if most of them are") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  REQUIRE(
      run_tri({"sample", "--cad", "cap.step", "-n", "50", "--no-truth", "-o", "cap.xyz"}, folder.path()).exit_code ==
      0);
  const std::string points = file_bytes(folder / "cap.xyz");
  folder.make("one.xyz", points + "1000 0 0\n");
  const Outcome one = run_tri({"register", "--cad", "cap.step", "one.xyz", "-o", "r.ply", "--json"}, folder.path());
  REQUIRE(one.exit_code == 0);
  const json summary = json::parse(one.out);
  CHECK(summary["far"]["indices"] == json::array({50}));
  CHECK(contains(one.err, "1 of 51 points"));
  CHECK(!contains(one.err, "--units"));
  const Outcome inches =
      run_tri({"register", "--cad", "cap.step", "one.xyz", "--units", "inch", "-o", "r.ply"}, folder.path());
  CHECK(inches.exit_code == 0);
  CHECK(contains(inches.err, "--units"));
  const Outcome quiet =
      run_tri({"register", "--cad", "cap.step", "one.xyz", "--units", "inch", "-o", "r.ply", "-q"}, folder.path());
  CHECK(quiet.err.empty());
  // A wider limit takes the point in.
  const Outcome wide =
      run_tri({"register", "--cad", "cap.step", "one.xyz", "--far", "5000", "-o", "r.ply", "--json"}, folder.path());
  CHECK(json::parse(wide.out)["far"]["points"] == 0);
}

TEST_CASE("tri register: takes the points as they are, or moved as a pose says") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "bracket", "-o", "part.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "part.step", "-n", "300", "--move", "-o", "scan.xyz"}, folder.path()).exit_code ==
          0);
  const auto farthest = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"register", "--cad", "part.step", "scan.xyz", "-o", "r.csv", "--report", "r.json"};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_tri(words, folder.path()).exit_code == 0);
    double most = 0;
    for (const auto& row : rows_of_file(folder / "r.csv", header)) most = std::max(most, std::abs(row[10]));
    return most;
  };
  CHECK(farthest({}) > 1);
  CHECK(!json::parse(file_bytes(folder / "r.json")).contains("alignment"));
  CHECK(farthest({"--pose", "scan.pose.json"}) < 1e-6);
  CHECK(json::parse(file_bytes(folder / "r.json"))["alignment"]["pose"].contains("matrix"));
}

TEST_CASE("tri register: refuses what it cannot use and leaves nothing") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  folder.make("a.xyz", "0 0 0\n");
  folder.make("bad.xyz", "0 0 zero\n");
  const auto before = folder.entries();
  const auto code = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"register", "--cad", "cap.step"};
    words.insert(words.end(), more.begin(), more.end());
    return run_tri(words, folder.path()).exit_code;
  };
  CHECK(code({"a.xyz", "-o", "r.stl"}) == 2);
  CHECK(code({"a.xyz", "-o", "r.csv", "--far", "0"}) == 2);
  CHECK(code({"a.xyz"}) == 2);
  CHECK(code({"missing.xyz", "-o", "r.csv"}) == 3);
  CHECK(code({"bad.xyz", "-o", "r.csv"}) == 3);
  CHECK(code({"a.xyz", "-o", "no/such/folder/r.csv"}) == 3);
  CHECK(folder.entries() == before);
}

TEST_CASE("tri register: an interrupt ends it with 130 and without output") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "boot-lid", "-o", "lid.step"}, folder.path()).exit_code == 0);
  // So many points far from the part take far longer than the interrupt.
  std::string points;
  for (int i = 0; i < 400000; ++i) points += std::to_string(i % 1000) + " " + std::to_string(i / 1000) + " 900\n";
  folder.make("far.xyz", points);
  const auto before = folder.entries();
  const Outcome outcome = run_tri({"register", "--cad", "lid.step", "far.xyz", "-o", "r.csv"}, folder.path(), "", 600);
  CHECK(outcome.exit_code == 130);
  CHECK(folder.entries() == before);
}

TEST_CASE("tri register: normals, intensity and further columns of the points follow, turned as the points are") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  folder.make("scan.csv",
              "x,y,z,nx,ny,nz,intensity,quality\n0,0,0,1,0,0,0.5,7\n1,2,3,0,1,0,0.25,8\n2,1,5,0,0,1,0.125,9\n");
  // A quarter turn about z.
  folder.make("pose.json", "{\"matrix\": [[0,-1,0,0],[1,0,0,0],[0,0,1,0],[0,0,0,1]]}");
  REQUIRE(run_tri({"register", "--cad", "cap.step", "scan.csv", "--pose", "pose.json", "-o", "r.csv"}, folder.path())
              .exit_code == 0);
  const auto found = rows_of_file(folder / "r.csv", header + ",nx,ny,nz,intensity,quality");
  REQUIRE(found.size() == 3);
  const double expected[3][5] = {{0, 1, 0, 0.5, 7}, {-1, 0, 0, 0.25, 8}, {0, 0, 1, 0.125, 9}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 5; ++k) CHECK(found[i][12 + k] == expected[i][k]);
}
