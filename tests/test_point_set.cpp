#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "meshops/error.hpp"
#include "meshops/points/point_set.hpp"

using namespace tri;

namespace {

/// Point i is at (i, 10 i, -i); every column says i in its own way.
PointSet full(std::size_t n) {
  PointSet set;
  for (std::size_t i = 0; i < n; ++i) {
    const double v = static_cast<double>(i);
    set.points.emplace_back(v, 10 * v, -v);
    set.normals.emplace_back(0, v, 1);
    set.intensity.push_back(v / 2);
    set.colors.push_back({static_cast<std::uint8_t>(i), 1, 2});
    set.scalars["time"].push_back(100 + v);
  }
  return set;
}

/// Every column of point `k` of `set` is what `full` gives point `i`.
bool is_point(const PointSet& set, std::size_t k, std::size_t i) {
  const PointSet one = full(i + 1);
  return set.points[k] == one.points[i] && set.normals[k] == one.normals[i] && set.intensity[k] == one.intensity[i] &&
         set.colors[k] == one.colors[i] && set.scalars.at("time")[k] == one.scalars.at("time")[i];
}

}  // namespace

TEST_CASE("point set: columns of another length and values that are not finite are refused by name") {
  PointSet set = full(3);
  CHECK_NOTHROW(validate(set));
  CHECK(column_names(set) == std::vector<std::string>{"normals", "intensity", "colors", "time"});
  set.intensity.pop_back();
  CHECK_THROWS_AS(validate(set), InvalidInput);
  set = full(3);
  set.scalars["empty"];
  CHECK_THROWS_AS(validate(set), InvalidInput);
  set = full(3);
  set.normals[1][2] = std::numeric_limits<double>::infinity();
  CHECK_THROWS_AS(validate(set), InvalidInput);
  set = full(3);
  set.points[2][0] = std::nan("");
  CHECK_THROWS_AS(validate(set), InvalidInput);
  set = full(3);
  set.intensity[0] = std::nan("");  // not known
  CHECK_NOTHROW(validate(set));
  CHECK_NOTHROW(validate(PointSet{}));
}

TEST_CASE("point set: append keeps every column, and fills what one side has not measured") {
  PointSet set = full(2);
  CHECK(append(set, full(3)).empty());
  REQUIRE(set.size() == 5);
  CHECK_NOTHROW(validate(set));
  for (const auto& [k, i] : {std::pair{0, 0}, {1, 1}, {2, 0}, {3, 1}, {4, 2}})
    CHECK(is_point(set, static_cast<std::size_t>(k), static_cast<std::size_t>(i)));

  PointSet bare;
  bare.points = {{7, 8, 9}};
  bare.scalars["ring"] = {4};
  set = full(2);
  CHECK(append(set, bare) == std::vector<std::string>{"normals", "intensity", "colors", "time", "ring"});
  CHECK_NOTHROW(validate(set));
  CHECK(is_point(set, 1, 1));
  CHECK(set.points[2] == Vec3(7, 8, 9));
  CHECK(set.normals[2] == Vec3(0, 0, 0));
  CHECK(std::isnan(set.intensity[2]));
  CHECK(set.colors[2] == std::array<std::uint8_t, 3>{0, 0, 0});
  CHECK(std::isnan(set.scalars["time"][2]));
  CHECK(std::isnan(set.scalars["ring"][0]));
  CHECK(set.scalars["ring"][2] == 4);

  PointSet other = bare;
  append(other, full(1));
  CHECK(std::isnan(other.intensity[0]));
  CHECK(other.intensity[1] == 0);
  PointSet empty;
  CHECK(append(empty, full(2)).empty());
  CHECK(is_point(empty, 1, 1));
  CHECK(append(empty, PointSet{}).empty());
  CHECK(empty.size() == 2);
  append(empty, empty);
  CHECK(empty.size() == 4);
  CHECK(is_point(empty, 3, 1));
}

TEST_CASE("point set: subset, keep and permute move all columns together") {
  const PointSet set = full(6);
  const std::vector<std::uint32_t> any{4, 0, 4}, ascending{1, 3, 5}, order{5, 3, 1, 0, 2, 4};
  const PointSet some = subset(set, any);
  CHECK_NOTHROW(validate(some));
  for (std::size_t k = 0; k < any.size(); ++k) CHECK(is_point(some, k, any[k]));
  PointSet kept = set;
  keep(kept, ascending);
  CHECK_NOTHROW(validate(kept));
  REQUIRE(kept.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) CHECK(is_point(kept, k, ascending[k]));
  PointSet sorted = set;
  permute(sorted, order);
  CHECK_NOTHROW(validate(sorted));
  for (std::size_t k = 0; k < 6; ++k) CHECK(is_point(sorted, k, order[k]));
  PointSet none = set;
  keep(none, {});
  CHECK(none.empty());
  CHECK_NOTHROW(validate(none));
}

TEST_CASE("point set: indices that are none are refused, and the set is untouched") {
  PointSet set = full(3);
  CHECK_THROWS_AS(subset(set, std::vector<std::uint32_t>{3}), InvalidInput);
  for (const std::vector<std::uint32_t>& wrong : {std::vector<std::uint32_t>{1, 1}, {2, 1}, {0, 3}})
    CHECK_THROWS_AS(keep(set, wrong), InvalidInput);
  for (const std::vector<std::uint32_t>& wrong : {std::vector<std::uint32_t>{0, 1}, {0, 1, 1}, {0, 1, 3}})
    CHECK_THROWS_AS(permute(set, wrong), InvalidInput);
  for (const double factor : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(scale(set, factor), InvalidInput);
  CHECK(set.size() == 3);
  CHECK(is_point(set, 2, 2));
  scale(set, 25.4);
  CHECK(set.points[2] == Vec3(2 * 25.4, 20 * 25.4, -2 * 25.4));
  CHECK(set.normals[2] == Vec3(0, 2, 1));
}
