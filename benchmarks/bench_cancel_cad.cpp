// How soon a cancel from another thread is heeded by what works on points and a model: index, registration, alignment
// and triangulation of a million points on the boot lid. The table is explained in cancel_watch.hpp.
//
//     bench_cancel_cad [NAME...]        TRI_BENCH_POINTS=100000 for fewer points
#include <memory>
#include <string>
#include <vector>

#include "cancel_watch.hpp"
#include "libtri/alignment/align.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/registration.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "libtri/triangulation/triangulate.hpp"

namespace {

using namespace tri;
using namespace tri::cancel_watch;

struct Input {
  Shape shape = example_part("boot-lid");
  CadModel model = make_cad_model(shape);
  Registration registration{model};
  std::vector<Vec3> points = [this] {
    Context context;
    const auto count = static_cast<std::uint64_t>(environment("TRI_BENCH_POINTS", 1'000'000));
    return measure(shape, {.points = count, .noise = 0.02}, context).points;
  }();
  std::vector<Vec3> moved = [this] {
    std::vector<Vec3> result;
    for (const Vec3& p : points) result.emplace_back(p[1] + 100, -p[0], p[2] + 50);
    return result;
  }();
};

const Input& input() {
  static const Input made;
  return made;
}

Case a_case(const std::string& name, const std::function<void(Context&)>& run) {
  return {name, [run] {
            const auto before = std::make_shared<std::vector<Vec3>>(input().points);
            return Case::Job{run, [before] { return *before == input().points ? "as it was" : "CHANGED"; }};
          }};
}

std::vector<Case> all_cases() {
  const Input& in = input();
  std::vector<Case> cases{a_case("index", [&in](Context& c) { Registration(in.model, c); }),
                          a_case("register", [&in](Context& c) { in.registration.register_points(in.points, c); })};
  for (const auto& [name, mode] : {std::pair{"align", AlignMode::automatic}, std::pair{"align icp", AlignMode::icp}}) {
    cases.push_back(a_case(
        name, [&in, mode = mode](Context& c) { align(in.model, in.registration, in.points, {}, {.mode = mode}, c); }));
    cases.push_back(a_case(std::string(name) + " (moved)", [&in, mode = mode](Context& c) {
      align(in.model, in.registration, in.moved, {}, {.mode = mode}, c);
    }));
  }
  for (const auto& [name, method] :
       {std::pair{"triangulate", Method::automatic}, std::pair{"triangulate shell", Method::shell}})
    cases.push_back(a_case(name, [&in, method = method](Context& c) {
      triangulate(in.model, in.registration, in.points, {.method = method}, c);
    }));
  cases.push_back(a_case("triangulate spanned", [&in](Context& c) {
    triangulate(in.model, in.registration, in.points, {.unmeasured = Unmeasured::span, .keep_patches = true}, c);
  }));
  return cases;
}

}  // namespace

int main(int argc, char** argv) {
  measure_chosen(all_cases(), argc, argv);
}
