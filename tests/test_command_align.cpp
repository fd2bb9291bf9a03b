// Runs `tri align`, and `tri triangulate` on points in another pose.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// Every number of a text, without a header line.
std::vector<double> numbers(const std::string& path, bool header = false) {
  std::istringstream in(file_bytes(path));
  std::string line;
  if (header) std::getline(in, line);
  std::vector<double> result;
  while (std::getline(in, line)) {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream cells(line);
    for (double x; cells >> x;) result.push_back(x);
  }
  return result;
}

// A bracket, and a scan of it in another pose.
void make_scan(const TemporaryFolder& folder) {
  REQUIRE(run_tri({"model", "bracket", "-o", "part.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "part.step", "-n", "2000", "--noise", "0.01", "--move", "--seed", "4", "-o", "scan.xyz"},
                  folder.path())
              .exit_code == 0);
}

// rms distance of the points of a file from where they truly are, mm.
double rms_to_truth(const TemporaryFolder& folder, const std::string& aligned) {
  const auto truth = numbers(folder / "scan.truth.csv", true), points = numbers(folder / aligned);
  REQUIRE(points.size() == 6000);
  REQUIRE(truth.size() == 22000);
  double sum = 0;
  for (std::size_t i = 0; i < 2000; ++i)
    for (std::size_t k = 0; k < 3; ++k) sum += std::pow(points[3 * i + k] - truth[11 * i + 4 + k], 2);
  return std::sqrt(sum / 2000);
}

}  // namespace

TEST_CASE("tri align: brings a scan to its true place, and the pose file does it again") {
  const TemporaryFolder folder;
  make_scan(folder);
  const Outcome outcome = run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "aligned.xyz", "--write-pose", "pose.json",
                                   "--report", "report.json"},
                                  folder.path());
  CHECK(outcome.exit_code == 0);
  CHECK(contains(outcome.out, "alignment: good"));
  // Noise of 0.01 and a pose that is much better than that.
  CHECK(rms_to_truth(folder, "aligned.xyz") < 0.011);
  const json report = json::parse(file_bytes(folder / "report.json"));
  CHECK(report["alignment"]["status"] == "good");
  CHECK(report["alignment"]["pose"]["matrix"] == json::parse(file_bytes(folder / "pose.json"))["matrix"]);

  for (const std::string pose : {"pose.json", "report.json"}) {
    REQUIRE(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "again.xyz", "--pose", pose, "--align", "none"}, folder.path())
                .exit_code == 0);
    CHECK(file_bytes(folder / "again.xyz") == file_bytes(folder / "aligned.xyz"));
  }
  // What is aligned stays, bit for bit.
  REQUIRE(run_tri({"align", "--cad", "part.step", "aligned.xyz", "-o", "again.xyz"}, folder.path()).exit_code == 0);
  CHECK(file_bytes(folder / "again.xyz") == file_bytes(folder / "aligned.xyz"));
}

TEST_CASE("tri align: starts from pairs of points") {
  const TemporaryFolder folder;
  make_scan(folder);
  const auto points = numbers(folder / "scan.xyz"), truth = numbers(folder / "scan.truth.csv", true);
  std::string pairs = "# measured, then on the model\n";
  for (const std::size_t i : {10u, 700u, 1500u, 1999u}) {
    for (std::size_t k = 0; k < 3; ++k) pairs += std::to_string(points[3 * i + k]) + " ";
    for (std::size_t k = 0; k < 3; ++k) pairs += std::to_string(truth[11 * i + 4 + k]) + (k < 2 ? "," : "\n");
  }
  folder.make("pairs.txt", pairs);
  REQUIRE(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "pairs.txt"}, folder.path()).exit_code == 0);
  CHECK(rms_to_truth(folder, "a.xyz") < 0.011);

  folder.make("line.txt", "0 0 0 0 0 0\n1 0 0 1 0 0\n2 0 0 2 0 0\n");
  const Outcome line = run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "line.txt"}, folder.path());
  CHECK(line.exit_code == 1);
  CHECK(contains(line.err, "on one line"));
  folder.make("two.txt", "0 0 0 0 0 0\n1 0 0 1 0 0\n");
  CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "two.txt"}, folder.path()).exit_code == 3);
  folder.make("words.txt", "0 0 0 0 0\n");
  CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "words.txt"}, folder.path()).exit_code == 3);
}

TEST_CASE("tri align: a scan in another unit fails, names the option, and the option cures it") {
  const TemporaryFolder folder;
  make_scan(folder);
  std::string inches;
  const auto points = numbers(folder / "scan.xyz");
  char text[64];
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::snprintf(text, sizeof text, "%.12g%c", points[i] / 25.4, i % 3 == 2 ? '\n' : ' ');
    inches += text;
  }
  folder.make("inch.xyz", inches);
  const Outcome outcome = run_tri({"align", "--cad", "part.step", "inch.xyz", "-o", "a.xyz", "--report", "r.json"}, folder.path());
  CHECK(outcome.exit_code == 1);
  CHECK(contains(outcome.err, "--units inch"));
  CHECK_FALSE(std::filesystem::exists(folder / "a.xyz"));
  CHECK(json::parse(file_bytes(folder / "r.json"))["alignment"]["status"] == "failed");
  REQUIRE(run_tri({"align", "--cad", "part.step", "inch.xyz", "-o", "a.xyz", "--units", "inch"}, folder.path()).exit_code == 0);
  CHECK(rms_to_truth(folder, "a.xyz") < 0.011);
}

TEST_CASE("tri align: refuses pose files without a rigid motion") {
  const TemporaryFolder folder;
  make_scan(folder);
  for (const std::string text : {"{}", "[1]", "{\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}",
                                 "{\"matrix\": [[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}", "{\"matrix\""}) {
    folder.make("pose.json", text);
    CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pose", "pose.json"}, folder.path()).exit_code == 3);
  }
  CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pose", "p.json", "--pairs", "q.txt"}, folder.path())
            .exit_code == 2);
}

TEST_CASE("tri triangulate: aligns points in another pose, and leaves those in the model's frame where they are") {
  const TemporaryFolder folder;
  make_scan(folder);
  REQUIRE(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "aligned.xyz"}, folder.path()).exit_code == 0);
  const std::vector<std::string> moved{"triangulate", "--cad", "part.step", "scan.xyz", "-o", "moved.ply", "--report", "moved.json"};
  const Outcome outcome = run_tri(moved, folder.path());
  CHECK(outcome.exit_code == 0);
  CHECK(contains(outcome.out, "alignment: good"));
  REQUIRE(run_tri({"triangulate", "--cad", "part.step", "aligned.xyz", "-o", "placed.ply", "--report", "placed.json"}, folder.path())
              .exit_code == 0);
  CHECK(file_bytes(folder / "moved.ply") == file_bytes(folder / "placed.ply"));
  CHECK(json::parse(file_bytes(folder / "moved.json"))["alignment"]["kept"] == false);
  CHECK(json::parse(file_bytes(folder / "placed.json"))["alignment"]["kept"] == true);
  // As they are, they do not lie on the model.
  auto unaligned = moved;
  unaligned.insert(unaligned.end(), {"--align", "none"});
  CHECK(run_tri(unaligned, folder.path()).exit_code == 1);
}
