// What every registered operator on points owes, whatever it does: run over the registry, so that a new operator is
// held to it by its registration alone.

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "meshops/error.hpp"
#include "meshops/registry.hpp"

using namespace tri;

namespace {

std::vector<const Operator*> points_operators() {
  std::vector<const Operator*> result;
  for (const auto& op : Registry::standard().operators())
    if (op->domain() == Domain::points) result.push_back(op.get());
  return result;
}

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

std::vector<std::pair<std::string, PointSet>> inputs() {
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

bool same(const Report& a, const Report& b) {
  return a.vertices_removed == b.vertices_removed && a.vertices_moved == b.vertices_moved && a.figures == b.figures &&
         a.skipped == b.skipped && a.notes == b.notes && a.maps.vertices == b.maps.vertices;
}

Report run(const Operator& op, PointSet& set, Context& context) {
  const std::shared_ptr<void> options = op.schema().make();
  return op.run(set, options.get(), context);
}

void for_all(const std::function<void(const Operator&, const PointSet&)>& check) {
  REQUIRE_FALSE(points_operators().empty());
  for (const Operator* op : points_operators()) {
    CAPTURE(op->name());
    for (const auto& input : inputs()) {
      CAPTURE(input.first);
      check(*op, input.second);
    }
  }
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
  for_all([](const Operator& op, const PointSet& input) {
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
  for_all([](const Operator& op, const PointSet& input) {
    if (!op.promises().idempotent) return;
    PointSet set = input;
    Context context;
    run(op, set, context);
    const PointSet once = set;
    CHECK(run(op, set, context).unchanged());
    CHECK(same_set(set, once));
  });
}

TEST_CASE("points contract: the result does not depend on the number of threads") {
  for_all([](const Operator& op, const PointSet& input) {
    PointSet first = input;
    Context one;
    one.threads = 1;
    const Report expected = run(op, first, one);
    for (const int threads : {2, 5}) {
      PointSet set = input;
      Context context;
      context.threads = threads;
      CHECK(same(run(op, set, context), expected));
      CHECK(same_set(set, first));
    }
  });
}

TEST_CASE("points contract: cancelled at any checkpoint, the set is as it was; progress never goes backwards") {
  for_all([](const Operator& op, const PointSet& input) {
    int checkpoints = 0;
    {
      PointSet set = input;
      Context context;
      context.threads = 1;
      context.on_checkpoint = [&] { ++checkpoints; };
      std::map<std::string, double> share;
      context.on_progress = [&](std::string_view step, double done) {
        double& before = share.try_emplace(std::string(step), 0.0).first->second;
        CHECK(done >= before);
        CHECK(done <= 1);
        before = done;
      };
      run(op, set, context);
    }
    CHECK(checkpoints > 0);
    for (int stop = 1; stop <= std::min(checkpoints, 40); ++stop) {
      PointSet set = input;
      Context context;
      context.threads = 1;
      int seen = 0;
      context.on_checkpoint = [&] {
        if (++seen == stop) context.cancel();
      };
      CHECK_THROWS_AS(run(op, set, context), Cancelled);
      CHECK(same_set(set, input));
    }
  });
}

TEST_CASE("points contract: an option out of range, or an inconsistent set, is refused and nothing is touched") {
  for (const Operator* op : points_operators()) {
    CAPTURE(op->name());
    const PointSet input = inputs()[0].second;
    Context context;
    for (const auto& entry : op->schema().entries()) {
      CAPTURE(entry.info.name);
      std::vector<OptionValue> wrong;
      if (entry.info.type == OptionInfo::Type::number) wrong = {std::nan(""), entry.info.minimum - 1};
      if (entry.info.type == OptionInfo::Type::integer) wrong = {static_cast<std::int64_t>(entry.info.minimum) - 1};
      for (const OptionValue& value : wrong) {
        PointSet set = input;
        const std::shared_ptr<void> options = op->schema().make();
        entry.set(options.get(), value);
        CHECK_THROWS_AS(op->run(set, options.get(), context), InvalidInput);
        CHECK(same_set(set, input));
      }
    }
    PointSet wrong_length = input, not_finite = input;
    wrong_length.colors.pop_back();
    not_finite.points[3][1] = std::nan("");
    CHECK_THROWS_AS(run(*op, wrong_length, context), InvalidInput);
    CHECK_THROWS_AS(run(*op, not_finite, context), InvalidInput);
  }
}
