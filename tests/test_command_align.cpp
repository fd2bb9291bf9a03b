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
  REQUIRE(run_tri({"sample", "--cad", "part.step", "-n", "2000", "--noise", "0.01", "--move", "--seed", "4", "-o",
                   "scan.xyz"},
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
  const Outcome outcome = run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "aligned.xyz", "--write-pose",
                                   "pose.json", "--report", "report.json"},
                                  folder.path());
  CHECK(outcome.exit_code == 0);
  CHECK(contains(outcome.out, "alignment: good"));
  // Noise of 0.01 and a pose that is much better than that.
  CHECK(rms_to_truth(folder, "aligned.xyz") < 0.011);
  const json report = json::parse(file_bytes(folder / "report.json"));
  CHECK(report["alignment"]["status"] == "good");
  CHECK(report["alignment"]["pose"]["matrix"] == json::parse(file_bytes(folder / "pose.json"))["matrix"]);

  for (const std::string pose : {"pose.json", "report.json"}) {
    REQUIRE(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "again.xyz", "--pose", pose, "--align", "none"},
                    folder.path())
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
  REQUIRE(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "pairs.txt"}, folder.path())
              .exit_code == 0);
  CHECK(rms_to_truth(folder, "a.xyz") < 0.011);

  folder.make("line.txt", "0 0 0 0 0 0\n1 0 0 1 0 0\n2 0 0 2 0 0\n");
  const Outcome line =
      run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "line.txt"}, folder.path());
  CHECK(line.exit_code == 1);
  CHECK(contains(line.err, "on one line"));
  folder.make("two.txt", "0 0 0 0 0 0\n1 0 0 1 0 0\n");
  CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "two.txt"}, folder.path())
            .exit_code == 3);
  folder.make("words.txt", "0 0 0 0 0\n");
  CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pairs", "words.txt"}, folder.path())
            .exit_code == 3);
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
  const Outcome outcome =
      run_tri({"align", "--cad", "part.step", "inch.xyz", "-o", "a.xyz", "--report", "r.json"}, folder.path());
  CHECK(outcome.exit_code == 1);
  CHECK(contains(outcome.err, "--units inch"));
  CHECK_FALSE(std::filesystem::exists(folder / "a.xyz"));
  CHECK(json::parse(file_bytes(folder / "r.json"))["alignment"]["status"] == "failed");
  REQUIRE(
      run_tri({"align", "--cad", "part.step", "inch.xyz", "-o", "a.xyz", "--units", "inch"}, folder.path()).exit_code ==
      0);
  CHECK(rms_to_truth(folder, "a.xyz") < 0.011);
}

TEST_CASE("tri align: refuses pose files without a rigid motion") {
  const TemporaryFolder folder;
  make_scan(folder);
  for (const std::string text : {"{}", "[1]", "{\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}",
                                 "{\"matrix\": [[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}", "{\"matrix\""}) {
    folder.make("pose.json", text);
    CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pose", "pose.json"}, folder.path())
              .exit_code == 3);
  }
  CHECK(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "a.xyz", "--pose", "p.json", "--pairs", "q.txt"},
                folder.path())
            .exit_code == 2);
}

TEST_CASE("tri triangulate: aligns points in another pose, and leaves those in the model's frame where they are") {
  const TemporaryFolder folder;
  make_scan(folder);
  REQUIRE(run_tri({"align", "--cad", "part.step", "scan.xyz", "-o", "aligned.xyz"}, folder.path()).exit_code == 0);
  const std::vector<std::string> moved{"triangulate", "--cad",     "part.step", "scan.xyz",
                                       "-o",          "moved.ply", "--report",  "moved.json"};
  const Outcome outcome = run_tri(moved, folder.path());
  CHECK(outcome.exit_code == 0);
  CHECK(contains(outcome.out, "alignment: good"));
  REQUIRE(run_tri({"triangulate", "--cad", "part.step", "aligned.xyz", "-o", "placed.ply", "--report", "placed.json"},
                  folder.path())
              .exit_code == 0);
  CHECK(file_bytes(folder / "moved.ply") == file_bytes(folder / "placed.ply"));
  CHECK(json::parse(file_bytes(folder / "moved.json"))["alignment"]["kept"] == false);
  CHECK(json::parse(file_bytes(folder / "placed.json"))["alignment"]["kept"] == true);
  // As they are, they do not lie on the model.
  auto unaligned = moved;
  unaligned.insert(unaligned.end(), {"--align", "none"});
  CHECK(run_tri(unaligned, folder.path()).exit_code == 1);
}

TEST_CASE("tri triangulate, compare, register --probe-radius: centres of a ball become the places that it touched") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "part.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "part.step", "-n", "800", "-o", "scan.xyz"}, folder.path()).exit_code == 0);
  const auto truth = numbers(folder / "scan.truth.csv", true);
  REQUIRE(truth.size() == 8800);
  std::string centres;
  char text[128];
  for (std::size_t i = 0; i < 800; ++i) {
    const double *p = &truth[11 * i + 4], *n = p + 3;
    std::snprintf(text, sizeof text, "%.12g %.12g %.12g\n", p[0] + 2 * n[0], p[1] + 2 * n[1], p[2] + 2 * n[2]);
    centres += text;
  }
  folder.make("centres.xyz", centres);
  const auto mean = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"compare", "--cad", "part.step", "centres.xyz", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return json::parse(run_tri(words, folder.path()).out)["overall"]["mean"].get<double>();
  };
  CHECK(mean({}) == doctest::Approx(2).epsilon(1e-6));
  CHECK(std::abs(mean({"--probe-radius", "2"})) < 1e-6);

  REQUIRE(
      run_tri({"register", "--cad", "part.step", "centres.xyz", "--probe-radius", "2", "-o", "r.csv"}, folder.path())
          .exit_code == 0);
  const auto rows = numbers(folder / "r.csv", true);
  REQUIRE(rows.size() == 9600);
  for (std::size_t i = 0; i < 800; ++i)
    for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(rows[12 * i + 1 + k] - truth[11 * i + 4 + k]) < 1e-6);

  REQUIRE(run_tri({"triangulate", "--cad", "part.step", "centres.xyz", "--probe-radius", "2", "-o", "mesh.ply",
                   "--report", "mesh.json"},
                  folder.path())
              .exit_code == 0);
  REQUIRE(
      run_tri({"compare", "--cad", "part.step", "mesh.ply", "--csv", "mesh.csv", "--report", "c.json"}, folder.path())
          .exit_code == 0);
  const json compared = json::parse(file_bytes(folder / "c.json"));
  CHECK(compared["overall"]["points"] == 800);
  CHECK(std::abs(compared["overall"]["max"].get<double>()) < 1e-6);
  CHECK(json::parse(file_bytes(folder / "mesh.json"))["options"]["probe_radius"] == 2);
  for (const char* bad : {"-1", "inf", "nan", "x"})
    CHECK(run_tri({"compare", "--cad", "part.step", "centres.xyz", "--probe-radius", bad}, folder.path()).exit_code ==
          2);
}

TEST_CASE(
    "tri align --align icp, none: points that are too large are named so within seconds, with the unit that cures it") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "blade", "-o", "part.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "part.step", "-n", "1500", "-o", "scan.xyz"}, folder.path()).exit_code == 0);
  const auto points = numbers(folder / "scan.xyz");
  const auto scaled = [&](double factor) {
    std::string lines;
    char text[64];
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::snprintf(text, sizeof text, "%.12g%c", points[i] * factor, i % 3 == 2 ? '\n' : ' ');
      lines += text;
    }
    folder.make("scaled.xyz", lines);
  };
  const auto said = [&](const char* mode) {
    const Outcome outcome =
        run_tri({"align", "--cad", "part.step", "scaled.xyz", "-o", "a.xyz", "--align", mode}, folder.path());
    CHECK(outcome.exit_code == 1);
    return outcome.err;
  };
  scaled(1000);
  for (const char* mode : {"auto", "icp", "none"}) CHECK(contains(said(mode), "--units 0.001"));
  scaled(0.001);
  for (const char* mode : {"auto", "icp", "none"}) CHECK(contains(said(mode), "--units m"));
  scaled(7);
  for (const char* mode : {"auto", "icp", "none"}) {
    const std::string text = said(mode);
    const std::size_t at = text.find("about ");
    REQUIRE(at != std::string::npos);
    CHECK(std::stod(text.substr(at + 6)) == doctest::Approx(7).epsilon(0.03));
  }
}
