// tri repair and tri check, as a user would run them.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.hpp"
#include "temporary_folder.hpp"

using namespace tri::test;
using nlohmann::json;

namespace {

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

using Quad = std::array<int, 4>;
constexpr std::array<Quad, 6> sides{
    {{1, 4, 3, 2}, {5, 6, 7, 8}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}}};

std::array<std::array<double, 3>, 8> corners(double low, double size) {
  const double a = low, b = low + size;
  return {{{a, a, a}, {b, a, a}, {b, b, a}, {a, b, a}, {a, a, b}, {b, a, b}, {b, b, b}, {a, b, b}}};
}

/// A cube as quadrilaterals, with a comment that no program writes by itself.
std::string cube_obj(double low = 0, double size = 1, int first = 0) {
  std::ostringstream obj;
  obj << "# made by hand\n";
  for (const auto& p : corners(low, size)) obj << "v  " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (const Quad& q : sides) {
    obj << 'f';
    for (const int v : q) obj << ' ' << v + first;
    obj << '\n';
  }
  return obj.str();
}

std::string cube_ply(const std::string& comment) {
  std::ostringstream ply;
  ply << "ply\nformat ascii 1.0\ncomment " << comment
      << "\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
         "property uchar blue\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n";
  for (const auto& p : corners(0, 1)) ply << p[0] << ' ' << p[1] << ' ' << p[2] << " 1 2 3\n";
  for (const Quad& q : sides) ply << "4 " << q[0] - 1 << ' ' << q[1] - 1 << ' ' << q[2] - 1 << ' ' << q[3] - 1 << '\n';
  return ply.str();
}

/// Binary STL with a header, normals and attribute bytes of its own.
std::string cube_stl() {
  std::string stl(80, '*');
  const std::uint32_t count = 12;
  stl.append(reinterpret_cast<const char*>(&count), 4);
  const auto points = corners(0, 1);
  for (const Quad& q : sides)
    for (const std::array<int, 3>& t : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
      float values[12] = {7, 7, 7};
      for (int k = 0; k < 3; ++k)
        for (int d = 0; d < 3; ++d) values[3 + 3 * k + d] = static_cast<float>(points[t[k] - 1][d]);
      stl.append(reinterpret_cast<const char*>(values), sizeof values);
      stl.append("ab");
    }
  return stl;
}

}  // namespace

TEST_CASE("tri repair: a clean mesh in its own format comes back byte by byte, comments and attributes included") {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> clean{
      {"cube.obj", cube_obj()}, {"cube.stl", cube_stl()}, {"cube.ply", cube_ply("kept")}};
  for (const auto& [name, bytes] : clean) {
    CAPTURE(name);
    folder.make(name, bytes);
    for (const std::string goal : {"solid", "auto"}) {
      std::vector<std::string> words{"repair", name, "-o", "out-" + name, "--goal", goal};
      if (name == "cube.ply") words.emplace_back("--ascii");
      const Outcome outcome = run_tri(words, folder.path());
      CHECK(outcome.exit_code == 0);
      CHECK(contains(outcome.out, "nothing had to be repaired"));
      CHECK(file_bytes(folder / ("out-" + name)) == bytes);
    }
  }
}

TEST_CASE("tri repair: cubes through and beside each other are solid by tri check, as STL too") {
  const TemporaryFolder folder;
  folder.make("in.obj", cube_obj(0, 1, 0) + cube_obj(0.4, 1.1, 8) + cube_obj(1.5, 1, 16));
  CHECK(run_tri({"check", "in.obj"}, folder.path()).exit_code == 1);
  for (const std::string name : {"out.stl", "out.ply", "out.obj", "out.off"}) {
    CAPTURE(name);
    const Outcome outcome = run_tri({"repair", "in.obj", "-o", name, "--goal", "solid"}, folder.path());
    CHECK(outcome.exit_code == 0);
    const Outcome check = run_tri({"check", name}, folder.path());
    CAPTURE(check.out);
    CHECK(check.exit_code == 0);
    CHECK(check.out.starts_with("solid"));
  }
}

TEST_CASE("tri repair: the result does not depend on the number of threads") {
  const TemporaryFolder folder;
  folder.make("in.obj", cube_obj(0, 1, 0) + cube_obj(0.4, 1.1, 8) + cube_obj(0.7, 1, 16));
  run_tri({"repair", "in.obj", "-o", "one.ply", "--threads", "1"}, folder.path());
  run_tri({"repair", "in.obj", "-o", "two.ply", "--threads", "2"}, folder.path());
  CHECK_FALSE(file_bytes(folder / "one.ply").empty());
  CHECK(file_bytes(folder / "one.ply") == file_bytes(folder / "two.ply"));
}

TEST_CASE("tri repair: says in text and JSON what was done, where, and how far that is") {
  const TemporaryFolder folder;
  std::string open = cube_obj();
  open.erase(open.rfind("f "));
  folder.make("in.obj", open);
  const Outcome text = run_tri({"repair", "in.obj", "-o", "out.off", "--goal", "solid"}, folder.path());
  CHECK(text.exit_code == 0);
  CHECK(contains(text.out, "holes closed: 1"));
  CHECK(contains(text.out, "at triangle "));
  const Outcome outcome =
      run_tri({"repair", "in.obj", "-o", "out.off", "--goal", "solid", "--json", "--report", "r.json"}, folder.path());
  const json report = json::parse(outcome.out);
  CHECK(report == json::parse(file_bytes(folder / "r.json")));
  CHECK(report["goal"] == "solid");
  CHECK(report["changed"] == true);
  CHECK(report["left"] == 0);
  CHECK(report["before"]["triangles"] == 10);
  CHECK(report["after"]["triangles"] == 12);
  CHECK(report["deviation"]["lost"].get<double>() < 1e-12);
  CHECK(report["deviation"]["added"].get<double>() == doctest::Approx(0.5).epsilon(0.1));
  const json& step = report["steps"].back();
  CHECK(step["operation"] == "make-solid");
  REQUIRE(step["places"].size() == 2);
  for (const json& place : step["places"]) {
    CHECK(place["triangle"].get<int>() >= 10);
    CHECK(place["at"].size() == 3);
  }
}

TEST_CASE("tri repair: a step that --max-deviation forbids is undone, named with its place, and the exit code is 1") {
  const TemporaryFolder folder;
  folder.make("in.obj", cube_obj(0, 1, 0) + cube_obj(0.4, 1.1, 8));
  const Outcome strict = run_tri({"repair", "in.obj", "-o", "out.obj", "--max-deviation", "0"}, folder.path());
  CHECK(strict.exit_code == 1);
  CHECK(contains(strict.out, "beyond max-deviation, undone: 1"));
  CHECK(contains(strict.out, "0 are allowed"));
  CHECK(run_tri({"repair", "in.obj", "-o", "out.obj", "--max-deviation", "1e-6"}, folder.path()).exit_code == 0);
}

TEST_CASE("tri repair: --dry-run says the same and writes nothing") {
  const TemporaryFolder folder;
  folder.make("in.obj", cube_obj(0, 1, 0) + cube_obj(0.4, 1.1, 8));
  const Outcome outcome = run_tri({"repair", "in.obj", "--dry-run"}, folder.path());
  CHECK(outcome.exit_code == 0);
  CHECK(contains(outcome.out, "crossing pairs"));
  CHECK(folder.entries() == std::vector<std::string>{"in.obj"});
}

TEST_CASE("tri repair: what cannot be repaired is named, the mesh is written, and the exit code is 1") {
  const TemporaryFolder folder;
  folder.make("in.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  const Outcome outcome = run_tri({"repair", "in.obj", "-o", "out.off", "--goal", "solid"}, folder.path());
  CHECK(outcome.exit_code == 1);
  CHECK(contains(outcome.out, "triangles without area: 1"));
  CHECK(contains(outcome.out, "triangle 0 has no area, at (1, 0, 0)"));
  CHECK(contains(outcome.err, "could not be repaired"));
  CHECK_FALSE(file_bytes(folder / "out.off").empty());
}

TEST_CASE("tri repair: crossing sheets stay open sheets unless a solid is asked for") {
  const TemporaryFolder folder;
  folder.make(
      "in.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nv 0.3 0.2 -1\nv 0.3 0.8 -1\nv 0.3 0.8 1\nv 0.3 0.2 1\nf 5 6 7 8\n");
  const Outcome outcome = run_tri({"repair", "in.obj", "-o", "out.ply"}, folder.path());
  CHECK(outcome.exit_code == 0);
  CHECK(contains(outcome.out, "goal: a surface"));
  const Outcome check = run_tri({"check", "out.ply", "--open"}, folder.path());
  CAPTURE(check.out);
  CHECK(check.exit_code == 0);
  CHECK(check.out.starts_with("open surface"));
}

TEST_CASE("tri repair and tri run: what the format cannot hold is said once") {
  const TemporaryFolder folder;
  folder.make("in.ply", cube_ply("coloured"));
  for (const std::vector<std::string>& words : {std::vector<std::string>{"repair", "in.ply", "-o", "out.stl"},
                                                std::vector<std::string>{"run", "in.ply", "!", "out.stl"}}) {
    const Outcome outcome = run_tri(words, folder.path());
    CHECK(outcome.exit_code == 0);
    CHECK(count_of(outcome.err, "colours") == 1);
  }
}

TEST_CASE("tri repair: wrong words are refused with 2") {
  const TemporaryFolder folder;
  folder.make("in.obj", cube_obj());
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"repair", "in.obj"}, std::vector<std::string>{"repair", "in.obj", "-o", "out.what"},
        std::vector<std::string>{"repair", "in.obj", "-o", "out.off", "--goal", "sphere"},
        std::vector<std::string>{"repair", "in.obj", "-o", "out.off", "--max-deviation", "2"}}) {
    const Outcome outcome = run_tri(words, folder.path());
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
  }
  CHECK(folder.entries() == std::vector<std::string>{"in.obj"});
}
