// Runs the built program as a user would.
#include <doctest/doctest.h>
#include <png.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;
using namespace std::string_literals;

namespace {

// A flat sheet of n x n squares with a hole of one square in the middle: two boundary loops.
std::string sheet_with_hole(int n = 5) {
  std::ostringstream obj;
  for (int i = 0; i <= n; ++i)
    for (int k = 0; k <= n; ++k) obj << "v " << k << ' ' << i << " 0\n";
  const auto at = [&](int i, int k) { return i * (n + 1) + k + 1; };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      if (i == n / 2 && k == n / 2) continue;
      obj << "f " << at(i, k) << ' ' << at(i, k + 1) << ' ' << at(i + 1, k + 1) << '\n';
      obj << "f " << at(i, k) << ' ' << at(i + 1, k + 1) << ' ' << at(i + 1, k) << '\n';
    }
  return obj.str();
}

int lines_of(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

// One clear line on standard error, nothing on standard output, nothing new in the folder.
void check_refused(const Outcome& outcome, int exit_code) {
  CAPTURE(outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK(outcome.out.empty());
  CHECK(lines_of(outcome.err) == 1);
  CHECK(outcome.err.starts_with("tri: "));
}

std::vector<std::string> commands() {
  std::vector<std::string> names{"info", "check", "run", "ops", "render"};
#ifdef TRI_WITH_CAD
  names.insert(names.end(), {"triangulate", "sample", "model"});
#endif
  return names;
}

}  // namespace

TEST_CASE("tri: without words prints its help to standard error and returns 2") {
  const TemporaryFolder folder;
  const Outcome outcome = run_tri({}, folder.path());
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.out.empty());
  CHECK(contains(outcome.err, "Usage"));
}

TEST_CASE("tri: --help and the help of every command hold an example and the commands' names") {
  const TemporaryFolder folder;
  const Outcome all = run_tri({"--help"}, folder.path());
  CHECK(all.exit_code == 0);
  CHECK(all.err.empty());
  CHECK(contains(all.out, "Example"));
  for (const std::string& command : commands()) {
    CAPTURE(command);
    CHECK(contains(all.out, "\n  " + command + " "));
    const Outcome help = run_tri({command, "--help"}, folder.path());
    CHECK(help.exit_code == 0);
    CHECK(help.err.empty());
    CHECK(contains(help.out, "Example"));
    CHECK(contains(help.out, "  tri " + command));
  }
}

TEST_CASE("tri: --version prints a number") {
  const TemporaryFolder folder;
  const Outcome outcome = run_tri({"--version"}, folder.path());
  CHECK(outcome.exit_code == 0);
  int major = -1, minor = -1;
  CHECK(std::sscanf(outcome.out.c_str(), "tri %d.%d", &major, &minor) == 2);
}

TEST_CASE("tri: a wrong word on the command line is refused in one line that quotes it, with 2") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole());
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong{
      {{"rendr", "in.obj"}, "rendr"},
      {{"render", "in.obj"}, "--output"},
      {{"render", "in.obj", "-o", "out.jpg"}, "out.jpg"},
      {{"render", "in.obj", "-o", "out.png", "--egdes"}, "--egdes"},
      {{"render", "in.obj", "-o", "out.png", "--zoom", "0"}, "--zoom"},
      {{"render", "in.obj", "-o", "out.png", "--size", "100"}, "--size"},
      {{"render", "in.obj", "-o", "out.png", "--size", "0x100"}, "--size"},
      {{"render", "in.obj", "-o", "out.png", "--view", "0,0,0"}, "--view"},
      {{"render", "in.obj", "!", "out.png"}, "!"},
      {{"info", "in.what"}, "in.what"},
      {{"info", "in.obj", "--as", "picture"}, "picture"},
      {{"ops", "fill-hole"}, "fill-hole"},
      {{"run", "in.obj"}, "OUT"},
      {{"run", "in.obj", "!", "fill-hole", "!", "out.ply"}, "fill-hole"},
      {{"run", "in.obj", "!", "!", "out.ply"}, "empty"},
      {{"run", "in.obj", "!", "!", "compact", "!", "out.ply"}, "!"},
      {{"run", "in.obj", "!", "fill-holes", "--max-egdes", "5", "!", "out.ply"}, "max-egdes"},
      {{"run", "in.obj", "!", "fill-holes", "--max-edges", "1", "!", "out.ply"}, "max-edges"},
      {{"run", "in.obj", "!", "fill-holes", "--max-edges", "many", "!", "out.ply"}, "many"},
      {{"run", "in.obj", "!", "fill-holes", "!", "out.what"}, "out.what"},
      // The steps are checked before the mesh is opened: this one does not exist.
      {{"run", "missing.obj", "!", "fill-holes", "--max-edges", "1", "!", "out.ply"}, "max-edges"},
  };
  for (const auto& [arguments, quoted] : wrong) {
    const Outcome outcome = run_tri(arguments, folder.path());
    check_refused(outcome, 2);
    CHECK_MESSAGE(contains(outcome.err, quoted), outcome.err);
    CHECK(folder.entries() == std::vector<std::string>{"in.obj"});
  }
}

TEST_CASE("tri: an input that no reader accepts is refused with 3 and leaves no output") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "folder.stl");
  folder.make("empty.stl", "");
  folder.make("garbage.stl", "\x01\x02\xff\xfe garbage \x00 \x80"s);
  folder.make("garbage.ply", std::string(5000, '\xee'));
  folder.make("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n");
  folder.make("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  folder.make("truncated.ply",
              "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
              "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n");
  const auto before = folder.entries().size();
  for (const char* name : {"missing.stl", "folder.stl", "empty.stl", "garbage.stl", "garbage.ply", "nan.obj",
                           "index.off", "truncated.ply"}) {
    CAPTURE(name);
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {"info", name}, {"render", name, "-o", "out.png"}, {"run", name, "!", "fill-holes", "!", "out.ply"}}) {
      const Outcome outcome = run_tri(arguments, folder.path());
      check_refused(outcome, 3);
      CHECK_MESSAGE(contains(outcome.err, name), outcome.err);
      CHECK(folder.entries().size() == before);
    }
  }
}

TEST_CASE("tri: an output that cannot be written is refused with 3") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole());
  std::filesystem::create_directory(folder / "folder.ply");
  std::filesystem::create_symlink("/dev/full", folder / "full.ply");
  std::filesystem::create_symlink("/dev/full", folder / "full.png");
  const auto before = folder.entries().size();
  check_refused(run_tri({"run", "in.obj", "!", "fill-holes", "!", "missing/out.ply"}, folder.path()), 3);
  check_refused(run_tri({"run", "in.obj", "!", "fill-holes", "!", "folder.ply"}, folder.path()), 3);
  check_refused(run_tri({"run", "in.obj", "!", "fill-holes", "!", "full.ply"}, folder.path()), 3);
  check_refused(run_tri({"render", "in.obj", "-o", "missing/out.png"}, folder.path()), 3);
  check_refused(run_tri({"render", "in.obj", "-o", "full.png"}, folder.path()), 3);
  check_refused(run_tri({"info", "in.obj"}, folder.path(), "/dev/full"), 3);
  check_refused(run_tri({"ops", "--json"}, folder.path(), "/dev/full"), 3);
  CHECK(folder.entries().size() == before);
}

TEST_CASE("tri: an older output stays as it was when the operation fails") {
  const TemporaryFolder folder;
  folder.make("broken.obj", "v 0 0 0\nf 1 2 3\n");
  folder.make("out.ply", "older");
  CHECK(run_tri({"run", "broken.obj", "!", "fill-holes", "!", "out.ply"}, folder.path()).exit_code == 3);
  CHECK(file_bytes(folder / "out.ply") == "older");
}

TEST_CASE("tri info: tells topology and defects of a mesh") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole());
  const Outcome text = run_tri({"info", "in.obj"}, folder.path());
  CHECK(text.exit_code == 0);
  CHECK(contains(text.out, "manifold, coherently oriented, open"));
  const Outcome outcome = run_tri({"info", "in.obj", "--json"}, folder.path());
  REQUIRE(outcome.exit_code == 0);
  const json info = json::parse(outcome.out);
  CHECK(info["kind"] == "mesh");
  CHECK(info["vertices"] == 36);
  CHECK(info["triangles"] == 48);
  CHECK(info["boundary_loops"] == 2);
  CHECK(info["euler"] == 0);
  CHECK(info["components"] == 1);
  CHECK(info["manifold"] == true);
  CHECK(info["closed"] == false);
  CHECK(info["area"].get<double>() == doctest::Approx(24));
  CHECK(info["box_max"] == json({5, 5, 0}));
}

TEST_CASE("tri check: 1 and the places if anything is wrong, 0 if not") {
  const TemporaryFolder folder;
  folder.make("sheet.obj", sheet_with_hole());
  const Outcome wrong = run_tri({"check", "sheet.obj", "--json"}, folder.path());
  CHECK(wrong.exit_code == 1);
  const json report = json::parse(wrong.out);
  CHECK(report["verdict"] == "open surface");
  CHECK(report["wrong"] == true);
  CHECK(report["counts"]["boundary_loops"] == 2);
  CHECK(report["places"]["boundary_loops"].size() == 2);
  CHECK(report["defects"]["boundary loops"] == 2);
  const Outcome open = run_tri({"check", "sheet.obj", "--open"}, folder.path());
  CHECK(open.exit_code == 0);
  CHECK(contains(open.out, "nothing is wrong"));
  folder.make("solid.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
  const Outcome solid = run_tri({"check", "solid.off"}, folder.path());
  CHECK(solid.exit_code == 0);
  CHECK(contains(solid.out, "solid"));
}

TEST_CASE("tri run: fills the hole, reports it, and writes the mesh") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole());
  const Outcome outcome =
      run_tri({"run", "in.obj", "!", "fill-holes", "--max-edges", "4", "!", "out.ply", "--json"}, folder.path());
  REQUIRE(outcome.exit_code == 0);
  const json report = json::parse(outcome.out);
  CHECK(report["triangles"] == 50);
  CHECK(report["steps"].back()["operation"] == "fill-holes");
  CHECK(report["steps"].back()["faces_added"] == 2);
  const json info = json::parse(run_tri({"info", "out.ply", "--json"}, folder.path()).out);
  CHECK(info["boundary_loops"] == 1);
  CHECK(info["area"].get<double>() == doctest::Approx(25));
}

TEST_CASE("tri run: a saved recipe does the same as the command line, byte for byte") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole());
  CHECK(run_tri({"run", "--save", "recipe.json", "in.obj", "!", "fill-holes", "--max-edges", "4", "!", "compact", "!",
                 "a.ply"},
                folder.path())
            .exit_code == 0);
  CHECK(
      run_tri({"run", "--recipe", "recipe.json", "in.obj", "b.ply", "--save", "again.json"}, folder.path()).exit_code ==
      0);
  CHECK(file_bytes(folder / "a.ply") == file_bytes(folder / "b.ply"));
  CHECK(file_bytes(folder / "recipe.json") == file_bytes(folder / "again.json"));
  const json recipe = json::parse(file_bytes(folder / "recipe.json"));
  CHECK(recipe == json::parse(R"({"version": 1, "steps": [{"op": "fill-holes", "max-edges": 4}, {"op": "compact"}]})"));
}

TEST_CASE("tri run: a wrong recipe is refused before the mesh is opened") {
  const TemporaryFolder folder;
  folder.make("version.json", R"({"version": 7, "steps": []})");
  folder.make("key.json", R"({"version": 1, "steps": [{"op": "fill-holes", "max-egdes": 4}]})");
  folder.make("range.json", R"({"version": 1, "steps": [{"op": "fill-holes", "max-edges": -4}]})");
  folder.make("text.json", "fill-holes");
  for (const char* recipe : {"version.json", "key.json", "range.json", "text.json"}) {
    const Outcome outcome = run_tri({"run", "--recipe", recipe, "missing.obj", "out.ply"}, folder.path());
    check_refused(outcome, 2);
    CHECK_MESSAGE(contains(outcome.err, recipe), outcome.err);
  }
  check_refused(run_tri({"run", "--recipe", "none.json", "missing.obj", "out.ply"}, folder.path()), 3);
}

TEST_CASE("tri run: without a step changes nothing but the format") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole());
  CHECK(run_tri({"run", "in.obj", "a.ply"}, folder.path()).exit_code == 0);
  CHECK(run_tri({"run", "a.ply", "b.off"}, folder.path()).exit_code == 0);
  CHECK(run_tri({"run", "b.off", "c.ply"}, folder.path()).exit_code == 0);
  CHECK(file_bytes(folder / "a.ply") == file_bytes(folder / "c.ply"));
}

TEST_CASE("tri ops: lists every operator with its options") {
  const TemporaryFolder folder;
  const json all = json::parse(run_tri({"ops", "--json"}, folder.path()).out);
  REQUIRE(all.size() > 0);
  const std::string list = run_tri({"ops"}, folder.path()).out;
  for (const json& op : all) {
    const std::string name = op["name"];
    CHECK(contains(list, name));
    const Outcome one = run_tri({"ops", name}, folder.path());
    CHECK(one.exit_code == 0);
    for (const json& option : op["options"]) CHECK(contains(one.out, option["name"].get<std::string>()));
    CHECK(json::parse(run_tri({"ops", name, "--json"}, folder.path()).out) == op);
  }
}

TEST_CASE("tri render: writes a PNG of the asked size whose centre shows the part") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole(4));  // its middle is not in the hole, which lies right above it
  const Outcome outcome = run_tri(
      {"render", "in.obj", "-o", "out.png", "--size", "320x200", "--view", "0,0,1", "--center", "1,1,0", "--json"},
      folder.path());
  REQUIRE(outcome.exit_code == 0);
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_file(&image, (folder / "out.png").c_str()) != 0);
  CHECK(image.width == 320);
  CHECK(image.height == 200);
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  REQUIRE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr) != 0);
  const std::uint8_t* centre = &pixels[3 * (100 * 320 + 160)];
  CHECK((centre[0] != 255 || centre[1] != 255 || centre[2] != 255));
  CHECK(pixels[0] == 255);
  CHECK(json::parse(outcome.out)["back"] == 0.0);
}

TEST_CASE("tri render: an unknown property is refused, naming those that there are") {
  const TemporaryFolder folder;
  folder.make("in.obj", sheet_with_hole());
  const Outcome outcome = run_tri({"render", "in.obj", "-o", "out.png", "--by", "deviation"}, folder.path());
  check_refused(outcome, 2);
  CHECK(contains(outcome.err, "deviation"));
  CHECK(folder.entries() == std::vector<std::string>{"in.obj"});
}

TEST_CASE("tri info: --units turns points into millimetres, by name or by number, and reports say so") {
  const TemporaryFolder folder;
  folder.make("p.xyz", "0 0 0\n1 0 0\n0 2 0\n");
  const auto info = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words{"info", "p.xyz", "--json"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = run_tri(words, folder.path());
    REQUIRE(outcome.exit_code == 0);
    return json::parse(outcome.out);
  };
  const std::vector<std::pair<std::string, double>> factors{
      {"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 0.001}, {"inch", 25.4}, {"ft", 304.8}, {"25.4", 25.4}, {"1e3", 1000}};
  for (const auto& unit : factors) {
    const std::string& name = unit.first;
    const double factor = unit.second;
    CAPTURE(name);
    const json report = info({"--units", name});
    CHECK(report["units"] == name);
    CHECK(report["mm_per_unit"] == factor);
    CHECK(report["box_max"][1].get<double>() == doctest::Approx(2 * factor));
  }
  CHECK(info({})["mm_per_unit"] == 1);
  for (const char* wrong : {"furlong", "0", "-1", "inf", "nan", ""})
    check_refused(run_tri({"info", "p.xyz", "--units", wrong}, folder.path()), 2);
  folder.make("m.obj", sheet_with_hole());
  check_refused(run_tri({"info", "m.obj", "--units", "m"}, folder.path()), 2);
}
