// What every registered operator on points owes, whatever it does: run over the registry, so that a new operator is
// held to it by its registration alone.

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "contract.hpp"

using namespace tri;
using namespace tri::test;

namespace {

/// Every column, each telling the index of its point.
PointSet with_columns(std::vector<Vec3> points) {
  PointSet set;
  set.points = std::move(points);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const double v = static_cast<double>(i);
    set.normals.emplace_back(0, v, 1);
    set.intensity.push_back(v / 2);
    set.colors.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i / 256), 2});
    set.scalars["index"].push_back(v);
  }
  return set;
}

std::vector<std::pair<std::string, PointSet>> point_inputs() {
  std::vector<std::pair<std::string, PointSet>> result;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(-4, 4);
  std::vector<Vec3> cloud, line, same(20, Vec3(1, 2, 3));
  for (int i = 0; i < 700; ++i) cloud.emplace_back(value(random), value(random), 0.01 * value(random));
  cloud.emplace_back(0, 0, 500);  // alone
  cloud.emplace_back(0.1, 0, 0);
  cloud.push_back(cloud[7]);
  for (int i = 0; i < 50; ++i) line.emplace_back(0.3 * i, 0, 0);
  result.emplace_back("cloud", with_columns(cloud));
  result.emplace_back("line", with_columns(line));
  result.emplace_back("one place", with_columns(same));
  result.emplace_back("one point", with_columns({Vec3(3, 2, 1)}));
  return result;
}

bool same_set(const PointSet& a, const PointSet& b) {
  return a.points == b.points && a.normals == b.normals && a.intensity == b.intensity && a.colors == b.colors &&
         a.scalars == b.scalars;
}

struct PointsKind {
  using Value = PointSet;
  static constexpr Domain domain = Domain::points;
  static constexpr int cancel_threads = 1;
  static std::vector<std::pair<std::string, PointSet>> inputs() { return ::point_inputs(); }
  static PointSet valid() { return ::point_inputs()[0].second; }
  static bool same(const PointSet& a, const PointSet& b) { return same_set(a, b); }
  static void check_cancelled(const PointSet& after, const PointSet& before) { CHECK(same_set(after, before)); }
};

std::vector<const Operator*> points_operators() {
  return operators_of(Domain::points);
}

}  // namespace

TEST_CASE("points contract: the empty set is left empty, with a zero report") {
  for (const Operator* op : points_operators()) {
    CAPTURE(op->name());
    PointSet set;
    Context context;
    const Report report = run(*op, set, context);
    CHECK(report.unchanged());
    CHECK(report.operation == op->name());
    CHECK(set.empty());
  }
}

TEST_CASE("points contract: points that stay are measured ones with all their columns, in their order, and counted") {
  for_all<PointsKind>([](const Operator& op, const PointSet& input) {
    PointSet set = input;
    Context context;
    const Report report = run(op, set, context);
    CHECK_NOTHROW(validate(set));
    CHECK(set.size() + report.vertices_removed == input.size() + report.vertices_added);
    CHECK_FALSE(set.empty());
    double before = -1;
    for (std::size_t k = 0; k < set.size(); ++k) {
      const auto i = static_cast<std::size_t>(set.scalars.at("index")[k]);
      CHECK(set.scalars.at("index")[k] > before);
      before = set.scalars.at("index")[k];
      CHECK(set.points[k] == input.points[i]);
      CHECK(set.normals[k] == input.normals[i]);
      CHECK(set.intensity[k] == input.intensity[i]);
      CHECK(set.colors[k] == input.colors[i]);
      if (!report.maps.vertices.empty()) CHECK(report.maps.vertices[i] == k);
    }
    if (report.unchanged()) CHECK(same_set(set, input));
    if (report.maps.vertices.empty()) {
      CHECK(report.vertices_removed == 0);
    } else {
      CHECK(report.maps.vertices.size() == input.size());
      CHECK(std::count(report.maps.vertices.begin(), report.maps.vertices.end(), ElementMaps::removed) ==
            static_cast<std::ptrdiff_t>(report.vertices_removed));
    }
  });
}

TEST_CASE("points contract: a second run changes nothing, where promised") {
  check_second_run<PointsKind>();
}

TEST_CASE("points contract: the result does not depend on the number of threads") {
  check_threads<PointsKind>();
}

TEST_CASE("points contract: cancelled at any checkpoint, the set is as it was; progress never goes backwards") {
  check_cancel<PointsKind>();
}

TEST_CASE("points contract: an option out of range is refused and nothing is touched") {
  check_options<PointsKind>();
}

TEST_CASE("points contract: an inconsistent set is refused") {
  for (const Operator* op : points_operators()) {
    CAPTURE(op->name());
    const PointSet input = point_inputs()[0].second;
    Context context;
    PointSet wrong_length = input, not_finite = input;
    wrong_length.colors.pop_back();
    not_finite.points[3][1] = std::nan("");
    CHECK_THROWS_AS(run(*op, wrong_length, context), InvalidInput);
    CHECK_THROWS_AS(run(*op, not_finite, context), InvalidInput);
  }
}
