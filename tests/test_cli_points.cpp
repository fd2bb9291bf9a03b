// Runs the commands of the program on points, as a user would.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "e57_writer.hpp"
#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;

namespace {

void check_refused_for(const Outcome& outcome, int exit_code, const std::string& word) {
  CAPTURE(outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.out.empty());
  CHECK(contains(outcome.err, word));
}

/// A sheet of n x n points, a millimetre apart, with their number as intensity.
std::string sheet(int n) {
  std::ostringstream text;
  text << "x,y,z,intensity,red,green,blue\n";
  for (int i = 0; i < n * n; ++i) text << i % n + 0.5 << ',' << i / n + 0.5 << ",0," << i << ",1,2," << i % 256 << '\n';
  return text.str();
}

/// Lines of a text that are no comment, as numbers.
std::vector<std::vector<double>> rows(const std::string& text) {
  std::vector<std::vector<double>> result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream words(line);
    result.emplace_back();
    for (double v = 0; words >> v;) result.back().push_back(v);
  }
  return result;
}

}  // namespace

TEST_CASE("tri run: points are thinned and cleaned, with their columns, into any format of points") {
  const TemporaryFolder folder;
  folder.make("p.csv", sheet(20) + "500.5,500.5,500.5,1,2,3,4\n");
  const json report = parsed(run_tri(
      {"run", "p.csv", "!", "remove-outliers", "--sigma", "2", "!", "thin", "--voxel", "2", "!", "out.xyz", "--json"},
      folder.path()));
  CHECK(report["points"] == 100);
  REQUIRE(report["steps"].size() == 2);
  CHECK(report["steps"][0]["operation"] == "remove-outliers");
  CHECK(report["steps"][0]["vertices_removed"] == 1);
  CHECK(report["steps"][1]["vertices_removed"] == 300);
  CHECK(report["units"] == "auto");
  const std::string text = file_bytes(folder / "out.xyz");
  CHECK(text.starts_with("# x y z intensity red green blue\n"));
  const auto points = rows(text);
  REQUIRE(points.size() == 100);
  for (const auto& p : points) {
    REQUIRE(p.size() == 7);
    const int i = static_cast<int>(p[3]);
    CHECK(p[0] == i % 20 + 0.5);
    CHECK(p[1] == i / 20 + 0.5);
    CHECK(p[6] == i % 256);
  }
  for (const char* name : {"a.ply", "a.pcd", "a.csv", "a.txt"}) {
    CAPTURE(name);
    CHECK(run_tri({"run", "p.csv", name}, folder.path()).exit_code == 0);
    const json info = parsed(run_tri({"info", name, "--as", "points", "--json"}, folder.path()));
    CHECK(info["points"] == 401);
    CHECK(info["intensity"]["high"] == 399);
    CHECK(info["colors"] == true);
  }
  // A PLY is read as points if the first step works on points.
  CHECK(parsed(run_tri({"run", "a.ply", "!", "thin", "--voxel", "1000", "!", "b.xyz", "--json"},
                       folder.path()))["points"] == 1);
  CHECK(run_tri({"run", "a.ply", "b.csv"}, folder.path()).exit_code == 0);
  CHECK(rows(file_bytes(folder / "b.csv")).size() == 402);
}

TEST_CASE("tri run: points cannot become a mesh without a model, and that is said before a file is opened") {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"run", "p.xyz", "!", "fill-holes", "!", "out.ply"},
        {"run", "p.xyz", "!", "thin", "!", "weld", "!", "out.ply"},
        {"run", "p.xyz", "out.stl"},
        {"run", "p.ply", "!", "thin", "!", "out.obj"}})
    check_refused_for(run_tri(words, folder.path()), 2, "needs a model");
  check_refused_for(run_tri({"run", "p.stl", "!", "weld", "!", "thin", "!", "out.xyz"}, folder.path()), 2,
                    "works on points");
  check_refused_for(run_tri({"run", "p.stl", "!", "weld", "!", "out.ply", "--units", "m"}, folder.path()), 2,
                    "--units");
  check_refused_for(run_tri({"run", "p.xyz", "!", "thin", "--voxel", "0", "!", "out.xyz"}, folder.path()), 2, "voxel");
  CHECK(folder.entries().empty());
}

TEST_CASE("tri info: an E57 file, its scans and columns; metres become millimetres") {
  const TemporaryFolder folder;
  E57TestFile file;
  E57TestScan scan{
      {E57TestField::doubles("cartesianX", {1, 2, 3}), E57TestField::doubles("cartesianY", {0, 0, 5}),
       E57TestField::doubles("cartesianZ", {0, 0, 0}), E57TestField::integers("cartesianInvalidState", 0, 2, {0, 2, 0}),
       E57TestField::floats("intensity", {0.25f, 1, 0.5f}), E57TestField::integers("rowIndex", 0, 9, {4, 5, 6})}};
  scan.more_xml =
      "<name>hall</name><sensorModel>S1</sensorModel><pose><rotation><w>0</w><z>1</z></rotation><translation><x>2</x>"
      "</translation></pose>";
  file.add(scan);
  folder.make("a.e57", file.bytes());
  const json info = parsed(run_tri({"info", "a.e57", "--json"}, folder.path()));
  CHECK(info["format"] == "E57");
  CHECK(info["points"] == 2);
  CHECK(info["points_skipped"] == 1);
  CHECK(info["mm_per_unit"] == 1000);
  CHECK(info["box_min"][0].get<double>() == doctest::Approx(-1000));
  CHECK(info["box_max"][0].get<double>() == doctest::Approx(1000));
  CHECK(info["intensity"]["low"] == 0.25);
  CHECK(info["columns"]["rowIndex"]["high"] == 6);
  CHECK(info["scans"][0]["name"] == "hall");
  CHECK(info["scans"][0]["translation"][0] == 2000);
  const Outcome text = run_tri({"info", "a.e57"}, folder.path());
  for (const char* word :
       {"E57", "hall", "S1", "1 not measured", "turned by 180", "rowIndex", "converted to millimetres"})
    CHECK(contains(text.out + text.err, word));
  CHECK(parsed(run_tri({"info", "a.e57", "--json", "--units", "mm"}, folder.path()))["box_max"][1] == 0);
}

#ifdef TRI_WITH_CAD
TEST_CASE("tri triangulate: thinned and cleaned points keep their number in the file and their columns") {
  const TemporaryFolder folder;
  REQUIRE(run_tri({"model", "sphere-cap", "-o", "cap.step"}, folder.path()).exit_code == 0);
  REQUIRE(run_tri({"sample", "--cad", "cap.step", "-n", "3000", "-o", "cap.xyz"}, folder.path()).exit_code == 0);
  // The index of each point as its intensity and, in a column that the mesh has too, as its deviation.
  std::ostringstream csv;
  csv << "x,y,z,intensity,red,green,blue,deviation\n";
  csv.precision(17);
  const auto points = rows(file_bytes(folder / "cap.xyz"));
  for (std::size_t i = 0; i < points.size(); ++i)
    csv << points[i][0] << ',' << points[i][1] << ',' << points[i][2] << ',' << i << ',' << i % 256 << ",0,9," << i
        << '\n';
  csv << "9000,9000,9000,0,0,0,0,0\n";
  folder.make("cap.csv", csv.str());
  const double voxel =
      2 * std::sqrt(parsed(run_tri({"info", "cap.step", "--json"}, folder.path()))["area"].get<double>() / 3000);
  const json report = parsed(run_tri({"triangulate", "--cad", "cap.step", "cap.csv", "-o", "cap.ply", "--ascii",
                                      "--json", "--remove-outliers", "--voxel", std::to_string(voxel)},
                                     folder.path()));
  CHECK(report["points"] == 3001);
  const auto removed = report["removed_outliers"].get<std::vector<int>>();
  CHECK(std::count(removed.begin(), removed.end(), 3000) == 1);
  CHECK(report["preparation"].size() == 2);
  CHECK(report["points_used"].get<int>() < 2000);
  CHECK(report["options"]["voxel"].get<double>() == doctest::Approx(voxel));
  std::istringstream ply(file_bytes(folder / "cap.ply"));
  std::vector<std::string> names;
  std::size_t vertices = 0;
  for (std::string line; std::getline(ply, line) && line != "end_header";) {
    std::istringstream words(line);
    std::string word, type, name;
    words >> word >> type >> name;
    if (word == "element" && type == "vertex") vertices = std::stoul(name);
    if (word == "property" && type != "list") names.push_back(name);
  }
  const auto column = [&](const char* name) {
    const auto found = std::find(names.begin(), names.end(), name);
    REQUIRE(found != names.end());
    return static_cast<std::size_t>(found - names.begin());
  };
  CHECK(vertices == report["vertices"].get<std::size_t>());
  for (std::size_t v = 0; v < vertices; ++v) {
    std::string line;
    std::getline(ply, line);
    const auto row = rows(line + "\n").at(0);
    const auto index = static_cast<std::size_t>(row[column("point_index")]);
    REQUIRE(index < points.size());
    CHECK(row[column("intensity")] == static_cast<double>(index));
    CHECK(row[column("input_deviation")] == static_cast<double>(index));
    CHECK(row[column("red")] == static_cast<double>(index % 256));
    CHECK(row[column("x")] == points[index][0]);
  }
}
#endif
