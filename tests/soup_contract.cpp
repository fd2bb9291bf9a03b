// What every registered operator on soups owes, whatever it does: run over the registry, so that a new operator is held to
// it by its registration alone.

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <map>

#include "meshops/error.hpp"
#include "meshops/registry.hpp"
#include "meshops/soup_edit.hpp"
#include "soup_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

std::vector<const Operator*> soup_operators() {
  std::vector<const Operator*> result;
  for (const auto& op : Registry::standard().operators())
    if (op->domain() == Domain::soup && op->result() == Domain::soup) result.push_back(op.get());
  return result;
}

/// Inputs on which most operators find something to do.
std::vector<std::pair<std::string, Soup>> inputs() {
  std::vector<std::pair<std::string, Soup>> result;
  const auto add = [&](const char* name, const Soup& soup) { result.emplace_back(name, with_attributes(soup)); };
  add("cube", cube());
  add("loose triangles", exploded(sphere(8, 3)));
  add("cavity facing outward", joined(cube({0, 0, 0}, 3), cube({1, 1, 1}, 1)));
  Soup twice = cube();
  twice.triangles.push_back({3, 0, 2});
  twice.triangles.push_back({0, 3, 2});
  twice.triangles.push_back({4, 7, 5});
  add("duplicates of both kinds", twice);
  Soup turned = sphere(7, 4);
  for (std::size_t i = 0; i < turned.triangles.size(); i += 3) std::swap(turned.triangles[i][0], turned.triangles[i][1]);
  add("some turned", turned);
  Soup caps = sheet(3, 2);
  caps.points.emplace_back(0.5, 0, 0);
  caps.points.emplace_back(1.5, 1, 0);
  caps.triangles.push_back({0, 12, 1});
  caps.triangles.push_back({5, 13, 6});
  caps.triangles.push_back({5, 5, 6});
  add("caps and fins", caps);
  Soup needles = sphere(6, 2);
  for (int i = 0; i < 6; ++i) needles.points[static_cast<std::size_t>(1 + i)] = Vec3(0, 0, -1);
  add("sides of no length", needles);
  Soup touching = joined(cube(), cube({1, 1, 0}));
  for (Triangle& t : touching.triangles)
    for (std::uint32_t& v : t) v = v == 8 ? 3 : v == 12 ? 7 : v;
  add("cubes with an edge in common", touching);
  Soup junctions = joined(sheet(4, 1), sheet(2, 1));
  for (std::size_t i = 10; i < junctions.points.size(); ++i)
    junctions.points[i] = Vec3(2 * junctions.points[i][0], junctions.points[i][1] - 1, 0);
  add("sheets that meet in T-junctions", junctions);
  return result;
}

Report run(const Operator& op, Soup& soup, Context& context) {
  const std::shared_ptr<void> options = op.schema().make();
  return op.run(soup, options.get(), context);
}

bool same(const Report& a, const Report& b) {
  return a.vertices_added == b.vertices_added && a.vertices_removed == b.vertices_removed &&
         a.vertices_moved == b.vertices_moved && a.faces_added == b.faces_added && a.faces_removed == b.faces_removed &&
         a.faces_reversed == b.faces_reversed && a.edges_flipped == b.edges_flipped && a.skipped == b.skipped &&
         a.figures == b.figures && a.notes == b.notes && a.touched_vertices == b.touched_vertices &&
         a.touched_faces == b.touched_faces;
}

void for_all(const std::function<void(const Operator&, const Soup&)>& check) {
  for (const Operator* op : soup_operators()) {
    CAPTURE(op->name());
    for (const auto& input : inputs()) {
      CAPTURE(input.first);
      check(*op, input.second);
    }
  }
}

}  // namespace

TEST_CASE("soup contract: no points, and points without triangles, are left alone") {
  for (const Operator* op : soup_operators()) {
    CAPTURE(op->name());
    Soup none, points;
    points.points = {{0, 0, 0}, {1, 2, 3}};
    const Soup before = points;
    Context context;
    const Report report = run(*op, none, context);
    CHECK(report.unchanged());
    CHECK(report.operation == op->name());
    CHECK(none.points.empty());
    CHECK(run(*op, points, context).unchanged());
    CHECK(same_soup(points, before));
  }
}

TEST_CASE("soup contract: a closed, well-shaped mesh is returned bit for bit, with a zero report") {
  for (const Operator* op : soup_operators()) {
    if (!op->promises().leaves_good_mesh) continue;
    CAPTURE(op->name());
    Soup soup = with_attributes(sphere(9, 5));
    const Soup before = soup;
    Context context;
    const Report report = run(*op, soup, context);
    CHECK(report.unchanged());
    CHECK(report.skipped.empty());
    CHECK(report.touched_vertices.empty());
    CHECK(report.touched_faces.empty());
    CHECK(same_soup(soup, before));
  }
}

TEST_CASE("soup contract: indices and attributes fit afterwards, and the report counts what changed") {
  for_all([](const Operator& op, const Soup& input) {
    Soup soup = input;
    Context context;
    const Report report = run(op, soup, context);
    CHECK_NOTHROW(check_soup(soup));
    CHECK(soup.points.size() + report.vertices_removed == input.points.size() + report.vertices_added);
    CHECK(soup.triangles.size() + report.faces_removed == input.triangles.size() + report.faces_added);
    for (const std::uint32_t f : report.touched_faces) CHECK(f < soup.triangles.size());
    for (const std::uint32_t v : report.touched_vertices) CHECK(v < soup.points.size());
    if (report.unchanged()) CHECK(same_soup(soup, input));
    else CHECK_FALSE(same_soup(soup, input));
    for (std::size_t i = 0; report.vertices_moved == 0 && i < soup.points.size(); ++i)
      CHECK(soup.vertex_scalars.at("x")[i] == doctest::Approx(soup.points[i][0]));
    CHECK(soup.face_labels == input.face_labels);
    // The group of a triangle still follows from the triangle that it comes from.
    for (std::size_t i = 0; i < soup.triangles.size(); ++i)
      CHECK(soup.face_scalars.at("group")[i] == std::fmod(soup.face_scalars.at("id")[i], 2));
  });
}

TEST_CASE("soup contract: a second run changes nothing, where promised") {
  for_all([](const Operator& op, const Soup& input) {
    if (!op.promises().idempotent) return;
    Soup soup = input;
    Context context;
    run(op, soup, context);
    const Soup once = soup;
    CHECK(run(op, soup, context).unchanged());
    CHECK(same_soup(soup, once));
  });
}

TEST_CASE("soup contract: the result does not depend on the number of threads") {
  for_all([](const Operator& op, const Soup& input) {
    Soup first = input;
    Context one;
    one.threads = 1;
    const Report expected = run(op, first, one);
    for (const int threads : {2, 5}) {
      Soup soup = input;
      Context context;
      context.threads = threads;
      CHECK(same(run(op, soup, context), expected));
      CHECK(same_soup(soup, first));
    }
  });
}

TEST_CASE("soup contract: cancelled at any checkpoint, the soup is as it was; progress never goes backwards") {
  for_all([](const Operator& op, const Soup& input) {
    int checkpoints = 0;
    {
      Soup soup = input;
      Context context;
      context.on_checkpoint = [&] { ++checkpoints; };
      std::map<std::string, double> share;
      context.on_progress = [&](std::string_view step, double done) {
        double& before = share.try_emplace(std::string(step), 0.0).first->second;
        CHECK(done >= before);
        CHECK(done <= 1);
        before = done;
      };
      run(op, soup, context);
    }
    CHECK(checkpoints > 0);
    for (int stop = 1; stop <= std::min(checkpoints, 40); ++stop) {
      Soup soup = input;
      Context context;
      int seen = 0;
      context.on_checkpoint = [&] {
        if (++seen == stop) context.cancel();
      };
      CHECK_THROWS_AS(run(op, soup, context), Cancelled);
      CHECK(same_soup(soup, input));
    }
  });
}

TEST_CASE("soup contract: an option out of range, or an inconsistent soup, is refused and nothing is touched") {
  for (const Operator* op : soup_operators()) {
    CAPTURE(op->name());
    for (const auto& entry : op->schema().entries()) {
      if (entry.info.type != OptionInfo::Type::number) continue;
      CAPTURE(entry.info.name);
      Soup soup = cube();
      const std::shared_ptr<void> options = op->schema().make();
      entry.set(options.get(), std::nan(""));
      Context context;
      CHECK_THROWS_AS(op->run(soup, options.get(), context), InvalidInput);
      CHECK(same_soup(soup, cube()));
    }
    Soup wrong_index = cube(), wrong_length = with_attributes(cube());
    wrong_index.triangles[3][1] = 8;
    wrong_length.corner_scalars["x"].pop_back();
    Context context;
    CHECK_THROWS_AS(run(*op, wrong_index, context), InvalidInput);
    CHECK_THROWS_AS(run(*op, wrong_length, context), InvalidInput);
  }
}
