// Runs `tri compare`.
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

// A square of side 2 in z = height, in two triangles.
std::string square_off(double height) {
  const std::string z = " " + std::to_string(height) + "\n";
  return "OFF\n4 2 0\n0 0" + z + "2 0" + z + "2 2" + z + "0 2" + z + "3 0 1 2\n3 0 2 3\n";
}

}  // namespace

TEST_CASE("tri compare: two meshes are as far apart as their planes, in text, JSON and CSV") {
  const TemporaryFolder folder;
  folder.make("a.off", square_off(0));
  folder.make("b.off", square_off(0.25));
  const Outcome outcome = run_tri({"compare", "a.off", "b.off", "-o", "a.ply", "--csv", "a.csv", "--report", "a.html",
                                   "--report", "a.json", "--samples", "1000", "--json"},
                                  folder.path());
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const json report = json::parse(outcome.out);
  CHECK(report == json::parse(file_bytes(folder / "a.json")));
  CHECK(report["hausdorff"].get<double>() == doctest::Approx(0.25));
  CHECK(report["hausdorff_bound"].get<double>() >= 0.25 - 1e-12);
  CHECK(report["rms"].get<double>() == doctest::Approx(0.25));
  for (const char* side : {"forward", "backward"}) {
    CHECK(report[side]["samples"] == 1000);
    CHECK(report[side]["area"].get<double>() == doctest::Approx(4));
  }
  const json info = json::parse(run_tri({"info", "a.ply", "--json"}, folder.path()).out);
  CHECK(info["triangles"] == 2);
  CHECK(std::count(info["vertex_properties"].begin(), info["vertex_properties"].end(), "deviation") == 1);
  CHECK(contains(file_bytes(folder / "a.csv"), "a.off,b.off,4,1000,0.25"));
  CHECK(contains(file_bytes(folder / "a.html"), "Hausdorff"));
  CHECK(contains(run_tri({"compare", "a.off", "b.off"}, folder.path()).out, "Hausdorff distance 0.25"));
}

TEST_CASE("tri compare: a file name of any kind does no harm in a page") {
  const TemporaryFolder folder;
  const std::string evil = "<script>alert(1)<'&\".off";
  folder.make(evil, square_off(0));
  folder.make("b.off", square_off(1));
  REQUIRE(run_tri({"compare", evil, "b.off", "--report", "a.html", "--samples", "10"}, folder.path()).exit_code == 0);
  const std::string page = file_bytes(folder / "a.html");
  CHECK(!contains(page, "<script>alert"));
  CHECK(contains(page, "&lt;script&gt;alert(1)"));
}

TEST_CASE("tri compare: wrong usage is refused with 2 before any file is opened") {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"a.stl"},
                                             {"a.stl", "b.stl", "c.stl"},
                                             {"a.stl", "b.xyz"},
                                             {"a.stl", "b.stl", "-o", "c.stl"},
                                             {"a.stl", "b.stl", "--csv", "c.txt"},
                                             {"a.stl", "b.stl", "--report", "c.pdf"},
                                             {"a.stl", "b.stl", "--tolerance", "0.1,0.1"},
                                             {"a.stl", "b.stl", "--tolerance", "-0.1"},
                                             {"a.stl", "b.stl", "--tolerance", "1,x"},
                                             {"a.stl", "b.stl", "--max-distance", "1"},
                                             {"a.stl", "b.stl", "--align", "auto"},
                                             {"a.stl", "b.stl", "--samples", "0"}}) {
    std::vector<std::string> arguments{"compare"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Outcome outcome = run_tri(arguments, folder.path());
    CAPTURE(words.back());
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
  CHECK(folder.entries().empty());
  folder.make("points.off", "OFF\n2 0 0\n0 0 0\n1 0 0\n");
  folder.make("a.off", square_off(0));
  CHECK(run_tri({"compare", "a.off", "points.off"}, folder.path()).exit_code == 1);
  CHECK(run_tri({"compare", "a.off", "missing.off"}, folder.path()).exit_code == 3);
  CHECK(run_tri({"compare", "a.off", "a.off", "--report", "missing/a.html"}, folder.path()).exit_code == 3);
}

#ifdef TRI_WITH_CAD

namespace {

// Points on a spherical cap, with noise of standard deviation 0.02 mm.
void measure_cap(const TemporaryFolder& folder) {
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "cap.step", "-n", "3000", "--noise", "0.02", "--no-truth", "-o", "cap.xyz"},
                  folder.path())
              .exit_code == 0);
}

json compared(const TemporaryFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments{"compare", "--cad", "cap.step"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  arguments.push_back("--json");
  const Outcome outcome = run_tri(arguments, folder.path());
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  return json::parse(outcome.out);
}

}  // namespace

TEST_CASE("tri compare --cad: the deviations are the noise that was put in, in text, JSON, CSV and colours") {
  const TemporaryFolder folder;
  measure_cap(folder);
  const json report = compared(folder, {"cap.xyz", "--tolerance", "-0.02,0.04", "-o", "out.ply", "--csv", "out.csv",
                                        "--report", "out.html", "--report", "out.json"});
  CHECK(report == json::parse(file_bytes(folder / "out.json")));
  const json& all = report["overall"];
  CHECK(all["points"] == 3000);
  CHECK(std::abs(all["mean"].get<double>()) < 4 * 0.02 / std::sqrt(3000.0));
  CHECK(all["standard_deviation"].get<double>() == doctest::Approx(0.02).epsilon(0.06));
  // The normal distribution's share from -1 to 2 standard deviations.
  CHECK(all["share_in_tolerance"].get<double>() == doctest::Approx(0.8186).epsilon(0.04));
  REQUIRE(report["faces"].size() == 1);
  CHECK(report["faces"][0]["rms"] == all["rms"]);
  CHECK(report["worst"][0]["deviation"].get<double>() ==
        doctest::Approx(0.02 - all["min"].get<double>() - 0.02 > all["max"].get<double>() - 0.02
                            ? all["min"].get<double>()
                            : all["max"].get<double>()));
  // The CSV holds the same numbers.
  std::istringstream csv(file_bytes(folder / "out.csv"));
  std::string head, line, field;
  std::getline(csv, head);
  std::getline(csv, line);
  std::istringstream fields(line);
  std::vector<std::string> values;
  while (std::getline(fields, field, ',')) values.push_back(field);
  REQUIRE(values.size() == 15);
  CHECK(std::count(head.begin(), head.end(), ',') == 14);
  CHECK(std::stod(values[5]) == all["mean"].get<double>());
  CHECK(std::stod(values[12]) == all["max"].get<double>());
  const json info = json::parse(run_tri({"info", "out.ply", "--as", "points", "--json"}, folder.path()).out);
  CHECK(info["points"] == 3000);
  CHECK(contains(file_bytes(folder / "out.ply"), "property double deviation"));
  CHECK(contains(file_bytes(folder / "out.ply"), "property int cad_face"));
  CHECK(contains(file_bytes(folder / "out.ply"), "property uchar red"));
  CHECK(contains(file_bytes(folder / "out.html"), "Worst places"));
}

TEST_CASE(
    "tri compare --cad: without a tolerance the colours end where 98% of the points do, and a single number is both "
    "sides") {
  const TemporaryFolder folder;
  measure_cap(folder);
  const json plain = compared(folder, {"cap.xyz"});
  CHECK(plain["tolerance"].is_null());
  CHECK(!plain["overall"].contains("in_tolerance"));
  CHECK(plain["colors"]["high"].get<double>() == doctest::Approx(2.33 * 0.02).epsilon(0.1));
  CHECK(plain["colors"]["low"].get<double>() == -plain["colors"]["high"].get<double>());
  CHECK(compared(folder, {"cap.xyz", "--tolerance", "0.04"})["tolerance"] == json({-0.04, 0.04}));
}

TEST_CASE("tri compare --cad: points beyond --max-distance are listed and not counted, in any unit of the file") {
  const TemporaryFolder folder;
  measure_cap(folder);
  folder.make("far.xyz", file_bytes(folder / "cap.xyz") + "0 0 5000\n");
  const json all = compared(folder, {"far.xyz"});
  CHECK(all["overall"]["points"] == 3001);
  CHECK(all["overall"]["max"].get<double>() > 100);
  const json near = compared(folder, {"far.xyz", "--max-distance", "1"});
  CHECK(near["points"] == 3001);
  CHECK(near["overall"]["points"] == 3000);
  CHECK(near["far"]["indices"] == json({3000}));
  CHECK(near["overall"]["rms"] == compared(folder, {"cap.xyz"})["overall"]["rms"]);
  CHECK(
      contains(run_tri({"compare", "--cad", "cap.step", "far.xyz", "--max-distance", "1"}, folder.path()).out, "3000"));
  // Far off because the unit is wrong: said, not refused.
  const Outcome inches = run_tri({"compare", "--cad", "cap.step", "cap.xyz", "--units", "m"}, folder.path());
  CHECK(inches.exit_code == 0);
  CHECK(contains(inches.err, "--units"));
}

TEST_CASE("tri triangulate --report: a page beside the JSON report, with the same deviations as tri compare") {
  const TemporaryFolder folder;
  measure_cap(folder);
  const Outcome outcome = run_tri(
      {"triangulate", "--cad", "cap.step", "cap.xyz", "-o", "cap.ply", "--report", "cap.html", "--report", "cap.json"},
      folder.path());
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  CHECK(json::parse(file_bytes(folder / "cap.json"))["points"] == 3000);
  const std::string page = file_bytes(folder / "cap.html");
  CHECK(contains(page, "Triangulation report"));
  REQUIRE(run_tri({"compare", "--cad", "cap.step", "cap.ply", "--report", "compare.html"}, folder.path()).exit_code ==
          0);
  // The table of faces, the same in both.
  const auto table = [](const std::string& html) {
    const auto begin = html.find("<h2>Faces of the model</h2>");
    return html.substr(begin, html.find("</table>", begin) - begin);
  };
  CHECK(table(page).size() > 300);
  CHECK(table(page) == table(file_bytes(folder / "compare.html")));
}

TEST_CASE("tri compare --cad: the vertices of a mesh count as points do, for any number of threads") {
  const TemporaryFolder folder;
  measure_cap(folder);
  REQUIRE(run_tri({"triangulate", "--cad", "cap.step", "cap.xyz", "--align", "none", "-o", "cap.ply"}, folder.path())
              .exit_code == 0);
  const json points = compared(folder, {"cap.xyz"}), mesh = compared(folder, {"cap.ply", "-o", "out.ply"});
  CHECK(mesh["measured"] == "vertices of a mesh");
  CHECK(mesh["overall"]["points"] == 3000);
  CHECK(mesh["overall"]["rms"].get<double>() == doctest::Approx(points["overall"]["rms"].get<double>()).epsilon(1e-9));
  const json info = json::parse(run_tri({"info", "out.ply", "--json"}, folder.path()).out);
  CHECK(info["triangles"] == mesh["triangles"]);
  CHECK(compared(folder, {"cap.ply", "--threads", "1"}) == compared(folder, {"cap.ply", "--threads", "2"}));
}

TEST_CASE("tri compare --cad: points in another pose are aligned when asked, by a pose file or from nothing") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "bracket", "-o", "cap.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "cap.step", "-n", "3000", "--noise", "0.02", "--move", "--no-truth", "-o",
                   "moved.xyz"},
                  folder.path())
              .exit_code == 0);
  const json as_they_lie = compared(folder, {"moved.xyz"});
  CHECK(as_they_lie["alignment"].is_null());
  CHECK(as_they_lie["overall"]["rms"].get<double>() > 1);
  const json given = compared(folder, {"moved.xyz", "--pose", "moved.pose.json", "--report", "out.html"});
  CHECK(given["overall"]["rms"].get<double>() == doctest::Approx(0.02).epsilon(0.1));
  CHECK(contains(file_bytes(folder / "out.html"), "Pose that takes the points to the model"));
  const json found = compared(folder, {"moved.xyz", "--align", "auto"});
  CHECK(found["overall"]["rms"].get<double>() <= 1.02 * given["overall"]["rms"].get<double>());
  CHECK(found["alignment"]["status"] != "failed");
}

#endif
