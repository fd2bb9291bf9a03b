#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "meshops/error.hpp"
#include "meshops/registry.hpp"

/// What the contract suites of meshes, soups and points have in common. Each states its kind of value once:
///
///     struct Kind {
///       using Value = Soup;
///       static constexpr Domain domain = Domain::soup;
///       static constexpr int cancel_threads = 0;  // when looking for checkpoints; 0: all
///       static std::vector<std::pair<std::string, Value>> inputs();  // on which most operators find something to do
///       static Value valid();  // any, for options out of range
///       static bool same(Value& a, Value& b);  // bit for bit
///       static void check_cancelled(Value& after, Value& before);
///     };
namespace tri::test {

/// The registered operators that take values of a domain and leave them in it.
inline std::vector<const Operator*> operators_of(Domain domain) {
  std::vector<const Operator*> result;
  for (const auto& op : Registry::standard().operators())
    if (op->domain() == domain && op->result() == domain) result.push_back(op.get());
  return result;
}

inline MeshView operand(Mesh& mesh) {
  return view_of(mesh);
}
inline MeshView operand(MeshView view) {
  return view;
}
inline Soup& operand(Soup& soup) {
  return soup;
}
inline PointSet& operand(PointSet& points) {
  return points;
}

/// Runs an operator with default options.
template <class Value>
Report run(const Operator& op, Value&& value, Context& context) {
  const std::shared_ptr<void> options = op.schema().make();
  return op.run(operand(value), options.get(), context);
}

/// All of two reports is equal, the time aside.
inline bool same_report(const Report& a, const Report& b) {
  return a.vertices_added == b.vertices_added && a.vertices_removed == b.vertices_removed &&
         a.vertices_moved == b.vertices_moved && a.faces_added == b.faces_added && a.faces_removed == b.faces_removed &&
         a.faces_reversed == b.faces_reversed && a.edges_flipped == b.edges_flipped && a.skipped == b.skipped &&
         a.figures == b.figures && a.notes == b.notes && a.touched_vertices == b.touched_vertices &&
         a.touched_faces == b.touched_faces && a.maps.vertices == b.maps.vertices && a.maps.edges == b.maps.edges &&
         a.maps.faces == b.maps.faces;
}

/// Calls `check` for every operator on every input, with both named.
template <class Kind>
void for_all(const std::function<void(const Operator&, const typename Kind::Value&)>& check) {
  REQUIRE_FALSE(operators_of(Kind::domain).empty());
  const auto inputs = Kind::inputs();
  for (const Operator* op : operators_of(Kind::domain)) {
    CAPTURE(op->name());
    for (const auto& input : inputs) {
      CAPTURE(input.first);
      check(*op, input.second);
    }
  }
}

template <class Kind>
void check_second_run() {
  for_all<Kind>([](const Operator& op, const typename Kind::Value& input) {
    if (!op.promises().idempotent) return;
    auto value = input;
    Context context;
    run(op, value, context);
    auto once = value;
    CHECK(run(op, value, context).unchanged());
    CHECK(Kind::same(value, once));
  });
}

/// The result does not depend on the number of threads, and a run can be repeated.
template <class Kind>
void check_threads() {
  for_all<Kind>([](const Operator& op, const typename Kind::Value& input) {
    auto first = input;
    Context one;
    one.threads = 1;
    const Report expected = run(op, first, one);
    for (const int threads : {1, 2, 5}) {
      auto value = input;
      Context context;
      context.threads = threads;
      CHECK(same_report(run(op, value, context), expected));
      CHECK(Kind::same(value, first));
    }
  });
}

/// Cancelled at any checkpoint, the value is in the state that its kind promises; progress is told, never goes
/// backwards, and every step of it that was begun is at its end when the operator returns.
template <class Kind>
void check_cancel() {
  for_all<Kind>([](const Operator& op, const typename Kind::Value& input) {
    std::atomic<int> checkpoints = 0;
    {
      auto value = input;
      Context context;
      context.threads = Kind::cancel_threads;
      context.on_checkpoint = [&] { ++checkpoints; };
      std::map<std::string, double> share;
      context.on_progress = [&](std::string_view step, double done) {
        double& before = share.try_emplace(std::string(step), 0.0).first->second;
        CHECK(done >= before);
        CHECK(done <= 1);
        before = done;
      };
      run(op, value, context);
      CHECK_FALSE(share.empty());
      for (const auto& [step, done] : share) {
        CAPTURE(step);
        CHECK(done == 1);
      }
    }
    CHECK(checkpoints > 0);
    for (int stop = 1; stop <= std::min(checkpoints.load(), 40); ++stop) {
      CAPTURE(stop);
      auto value = input, before = input;
      Context context;
      context.threads = Kind::cancel_threads;
      std::atomic<int> seen = 0;
      context.on_checkpoint = [&] {
        if (++seen == stop) context.cancel();
      };
      CHECK_THROWS_AS(run(op, value, context), Cancelled);
      Kind::check_cancelled(value, before);
    }
  });
}

/// An option out of range is refused, and nothing is touched.
template <class Kind>
void check_options() {
  for (const Operator* op : operators_of(Kind::domain)) {
    CAPTURE(op->name());
    for (const auto& entry : op->schema().entries()) {
      CAPTURE(entry.info.name);
      std::vector<OptionValue> wrong;
      if (entry.info.type == OptionInfo::Type::number) {
        wrong.push_back(std::nan(""));
        if (entry.info.minimum > -1e300) wrong.push_back(entry.info.minimum - 1);
        if (entry.info.maximum < 1e300) wrong.push_back(entry.info.maximum + 1);
      } else if (entry.info.type == OptionInfo::Type::integer) {
        if (entry.info.minimum > -2147483648.0) wrong.push_back(static_cast<std::int64_t>(entry.info.minimum) - 1);
        if (entry.info.maximum < 2147483647.0) wrong.push_back(static_cast<std::int64_t>(entry.info.maximum) + 1);
      }
      for (const OptionValue& out_of_range : wrong) {
        auto value = Kind::valid(), before = value;
        const std::shared_ptr<void> options = op->schema().make();
        entry.set(options.get(), out_of_range);
        Context context;
        CHECK_THROWS_AS(op->run(operand(value), options.get(), context), InvalidInput);
        CHECK(Kind::same(value, before));
      }
    }
  }
}

}  // namespace tri::test
