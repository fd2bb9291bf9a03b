#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>

#include "meshops/error.hpp"
#include "meshops/holes/sparse_cholesky.hpp"

using namespace tri;

namespace {

/// The Laplacian of a grid of triangles plus a little on the diagonal; of a second grid beside it nothing is joined.
SparseColumns grid_matrix(int width, int height, int grids, double diagonal) {
  SparseColumns a;
  for (int grid = 0; grid < grids; ++grid)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        std::map<int, double> column;
        const auto at = [&](int u, int v) { return grid * width * height + v * width + u; };
        column[at(x, y)] = diagonal;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}})
          if (x + dx >= 0 && x + dx < width && y + dy >= 0 && y + dy < height) column[at(x + dx, y + dy)] = -1;
        for (const auto& [row, value] : column) a.add(row, value);
        a.end_column();
      }
  return a;
}

std::vector<Vec3> some_points(std::int32_t n) {
  std::vector<Vec3> b;
  for (int i = 0; i < n; ++i) b.emplace_back(i % 7 - 3, i % 11 - 4, 1);
  return b;
}

double largest_rest(const SparseColumns& a, const std::vector<Vec3>& x, std::vector<Vec3> rest) {
  for (std::int32_t j = 0; j < a.columns(); ++j)
    for (std::int64_t p = a.first[j]; p < a.first[j + 1]; ++p) rest[a.row[p]] -= x[j] * a.value[p];
  double most = 0;
  for (const Vec3& r : rest) most = std::max(most, r.norm());
  return most;
}

constexpr EliminationLimits all_at_once{}, divided{300, 60};

}  // namespace

TEST_CASE("elimination_order: names every unknown once, whole or divided, joined or not") {
  Context context;
  for (const EliminationLimits& limits : {all_at_once, divided})
    for (const int grids : {1, 2, 40}) {
      const SparseColumns a = grid_matrix(grids > 2 ? 3 : 23, grids > 2 ? 2 : 17, grids, 7);
      std::vector<std::int32_t> order = elimination_order(a, context, limits);
      std::sort(order.begin(), order.end());
      REQUIRE(order.size() == static_cast<std::size_t>(a.columns()));
      for (std::int32_t i = 0; i < a.columns(); ++i) CHECK(order[i] == i);
    }
  CHECK(elimination_order({}, context).empty());
}

TEST_CASE("SparseCholesky: the solution fulfils the system, in every order of elimination") {
  Context context;
  for (const EliminationLimits& limits : {all_at_once, divided})
    for (const int grids : {1, 3}) {
      const SparseColumns a = grid_matrix(31, 20, grids, 6.5);
      const SparseCholesky factors(a, context, limits);
      REQUIRE(factors.positive_definite());
      const std::vector<Vec3> b = some_points(a.columns());
      CHECK(largest_rest(a, factors.solve(b, context), b) < 1e-12);
    }
}

TEST_CASE("SparseCholesky: a diagonal matrix is divided by its diagonal") {
  Context context;
  SparseColumns a;
  for (int i = 0; i < 5; ++i) a.add(i, 1 << i), a.end_column();
  const std::vector<Vec3> x = SparseCholesky(a, context).solve(some_points(5), context);
  for (int i = 0; i < 5; ++i) CHECK(x[i] == some_points(5)[i] / (1 << i));
}

TEST_CASE("SparseCholesky: says what is not positive definite") {
  Context context;
  CHECK_FALSE(SparseCholesky(grid_matrix(9, 9, 1, 1), context).positive_definite());
  CHECK_FALSE(SparseCholesky(grid_matrix(9, 9, 1, -7), context, divided).positive_definite());
  SparseColumns singular;  // (1 1; 1 1)
  for (int column = 0; column < 2; ++column) {
    for (int row = 0; row < 2; ++row) singular.add(row, 1);
    singular.end_column();
  }
  CHECK_FALSE(SparseCholesky(singular, context).positive_definite());
}

TEST_CASE("SparseCholesky: a cancel is heeded in the middle of the factors") {
  const SparseColumns a = grid_matrix(120, 120, 1, 7);
  Context counting;
  std::atomic<int> all = 0;
  counting.on_checkpoint = [&] { ++all; };
  const SparseCholesky factors(a, counting);
  REQUIRE(all > 1);
  Context context;
  std::atomic<int> left = all.load();
  context.on_checkpoint = [&] {
    if (--left == 0) context.cancel();
  };
  CHECK_THROWS_AS(SparseCholesky(a, context), Cancelled);
}
