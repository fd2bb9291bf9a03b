// Operators on different meshes at the same time: what scripts/tsan runs under the thread sanitizer.

#include <doctest/doctest.h>

#include <atomic>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "contract.hpp"
#include "mesh_check.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/editing/change_set.hpp"
#include "meshops/error.hpp"
#include "meshops/pipeline.hpp"
#include "meshops/to_soup.hpp"
#include "test_shapes.hpp"

using namespace tri;
using namespace tri::test;

namespace {

constexpr std::size_t at_once = 3;

/// Operators that work on a mesh in place, those for soups among them.
std::vector<const Operator*> operators_on_meshes() {
  std::vector<const Operator*> result;
  for (const Domain domain : {Domain::mesh, Domain::soup})
    for (const Operator* op : operators_of(domain)) result.push_back(op);
  return result;
}

Mesh work_piece() {
  Mesh mesh = bumpy_grid(16, 14);
  for (const int f : {60, 61, 63, 150, 151, 200, 330}) mesh.delete_face(FaceHandle(f), true);
  return mesh;
}

void on_threads(const std::function<void(std::size_t)>& work) {
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < at_once; ++i) threads.emplace_back(work, i);
  for (std::thread& t : threads) t.join();
}

}  // namespace

TEST_CASE("threads: operators run on meshes of their own at the same time, with the results of one after another") {
  const auto operators = operators_on_meshes();
  const Mesh input = work_piece();
  std::vector<Snapshot> expected;
  for (const Operator* op : operators) {
    Mesh mesh = input;
    Context context;
    run(*op, mesh, context);
    expected.push_back(snapshot(view_of(mesh)));
  }
  std::atomic<int> different{0};
  on_threads([&](std::size_t thread) {
    for (std::size_t i = 0; i < operators.size(); ++i) {
      const std::size_t k = (i + thread * operators.size() / at_once) % operators.size();
      Mesh mesh = input;
      Context context;
      context.threads = 2;
      run(*operators[k], mesh, context);
      different += snapshot(view_of(mesh)) != expected[k];
    }
  });
  CHECK(different == 0);
}

TEST_CASE("threads: the same operator runs on several meshes at the same time") {
  const Mesh input = work_piece();
  for (const Operator* op : operators_on_meshes()) {
    CAPTURE(op->name());
    std::vector<Snapshot> results(at_once);
    on_threads([&](std::size_t thread) {
      Mesh mesh = input;
      Context context;
      context.threads = 2;
      run(*op, mesh, context);
      results[thread] = snapshot(view_of(mesh));
    });
    for (const Snapshot& s : results) CHECK(s == results[0]);
  }
}

TEST_CASE("threads: meshes are recorded, undone and done again at the same time") {
  const auto operators = operators_on_meshes();
  std::atomic<int> different{0};
  on_threads([&](std::size_t thread) {
    for (std::size_t i = 0; i < operators.size(); ++i) {
      const Operator& op = *operators[(i + thread * operators.size() / at_once) % operators.size()];
      Mesh mesh = work_piece();
      const Snapshot before = snapshot(view_of(mesh));
      const auto options = op.schema().make();
      Context context;
      context.threads = 2;
      ChangeSet change = record(
          view_of(mesh), [&](MeshView view) { return op.run(view, options.get(), context); }, Recording::undoable,
          &context);
      const Snapshot after = snapshot(view_of(mesh));
      change.undo(mesh);
      different += snapshot(view_of(mesh)) != before;
      change.redo(mesh);
      different += snapshot(view_of(mesh)) != after;
    }
  });
  CHECK(different == 0);
}

TEST_CASE("threads: soups and points are worked on at the same time") {
  const Soup soup = [] {
    Mesh mesh = work_piece();
    return to_soup(view_of(mesh));
  }();
  std::vector<int> failed(at_once, 0);
  on_threads([&](std::size_t thread) {
    for (const Operator* op : operators_of(Domain::soup)) {
      Soup mine = soup;
      Context context;
      context.threads = 2;
      run(*op, mine, context);
      BuiltMesh built = build_mesh(mine, context);
      failed[thread] += !mesh_problems(built.mesh).empty();
    }
    for (const Operator* op : operators_of(Domain::points)) {
      PointSet points;
      points.points = soup.points;
      Context context;
      context.threads = 2;
      run(*op, points, context);
      failed[thread] += points.empty();
    }
  });
  for (const int f : failed) CHECK(f == 0);
}

TEST_CASE("threads: a cancel from another thread leaves a valid mesh, and under a recording the mesh as it was") {
  const Mesh input = bumpy_grid(40, 40);
  Mesh copy = input;
  const Snapshot before = snapshot(view_of(copy));
  for (const Operator* op : operators_on_meshes()) {
    CAPTURE(op->name());
    for (const bool recorded : {false, true}) {
      CAPTURE(recorded);
      for (const int checkpoints : {1, 3, 20}) {
        Mesh mesh = input;
        Context context;
        context.threads = 2;
        std::atomic<int> seen{0};
        std::atomic<bool> over{false};
        context.on_checkpoint = [&] { ++seen; };
        std::thread other([&] {
          while (seen < checkpoints && !over) std::this_thread::yield();
          context.cancel();
        });
        bool cancelled = false;
        const auto options = op->schema().make();
        const auto work = [&](MeshView view) { return op->run(view, options.get(), context); };
        try {
          if (recorded)
            record(view_of(mesh), work, Recording::undoable, &context);
          else
            work(view_of(mesh));
        } catch (const Cancelled&) {
          cancelled = true;
        }
        over = true;
        other.join();
        CHECK_VALID_MESH(mesh);
        if (recorded && cancelled) CHECK(snapshot(view_of(mesh)) == before);
      }
    }
  }
}

TEST_CASE("threads: pipelines of one registry run at the same time") {
  Pipeline pipeline;
  pipeline.add("fill-holes", {{"max-edges", 50}})
      .add("smooth", {{"iterations", 2}})
      .add("flip-diagonals")
      .add("compact");
  std::vector<Snapshot> results(at_once);
  on_threads([&](std::size_t thread) {
    Mesh mesh = work_piece();
    Context context;
    context.threads = 2;
    pipeline.run(view_of(mesh), context);
    results[thread] = snapshot(view_of(mesh));
  });
  for (const Snapshot& s : results) CHECK(s == results[0]);
}
