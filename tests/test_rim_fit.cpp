// clang-format off: OpenMesh does not compile after OpenCASCADE
#include "libtri/alignment/align.hpp"
#include "libtri/alignment/rim_fit.hpp"
// clang-format on

#include <doctest/doctest.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <cmath>
#include <gp_Pln.hxx>
#include <numbers>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "meshops/random_stream.hpp"

using namespace tri;

namespace {

constexpr double width = 100, height = 60, rim_noise = 0.02;

struct RimmedPart {
  explicit RimmedPart(const Shape& shape) : model(make_cad_model(shape)), registration(model) {}
  CadModel model;
  Registration registration;
};

// One flat face, open all around.
const RimmedPart& plate() {
  static const RimmedPart part(
      Shape(std::make_shared<Shape::Impl>(BRepBuilderAPI_MakeFace(gp_Pln(), 0, width, 0, height).Shape())));
  return part;
}

// Points spread evenly over the plate from x = `low` to `high`, noisy, with wild ones among and around them.
std::vector<Vec3> scan(double low, double high, std::size_t count, std::size_t wild, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.emplace_back(random.uniform(low, high), random.uniform(0, height), rim_noise * random.normal());
  for (std::size_t i = 0; i < wild; ++i)
    points.emplace_back(random.uniform(-10, width + 10), random.uniform(-10, height + 10), random.uniform(-10, 10));
  return points;
}

RimFit settled(const RimmedPart& part, const std::vector<Vec3>& points, const Pose& pose) {
  Context context;
  const Rim rim(part.model, part.registration, context);
  const FitTarget target{part.registration, part.model.diagonal, 0};
  const PointSample sample{points, {}};
  const auto residuals = target.residuals(points, {}, pose, context);
  std::vector<double> weights;
  for (const PointResidual& r : residuals) weights.push_back(r.on_edge || std::abs(r.value) > 5 * rim_noise ? 0 : 1);
  return fit_to_rim(rim, target, sample, pose, NormalEquations(residuals, weights), rim_noise,
                    1e-4 * part.model.diagonal, context);
}

}  // namespace

TEST_CASE("Rim: has the free edges and the sharp ones, whose inward side is the face's") {
  Context context;
  const Rim open(plate().model, plate().registration, context);
  REQUIRE(!open.empty());
  double around = 0;
  for (const Rim::Place& p : open.places()) {
    const bool across_x = p.point[0] < 1e-9 || p.point[0] > width - 1e-9;
    CHECK((across_x || p.point[1] < 1e-9 || p.point[1] > height - 1e-9));
    const Vec3 expected = across_x ? Vec3(p.point[0] < 1 ? 1 : -1, 0, 0) : Vec3(0, p.point[1] < 1 ? 1 : -1, 0);
    CHECK((p.inward - expected).norm() < 1e-9);
    around += 1;
  }
  // About a thousandth of the diagonal apart.
  CHECK(around == doctest::Approx(2 * (width + height) / (1e-3 * std::hypot(width, height))).epsilon(0.02));
  CHECK(open.near({50, 0.5, 0}, 0, 1) != nullptr);
  CHECK(open.near({50, 30, 0}, 0, 1) == nullptr);

  // Twelve edges of a box, each from both its faces; the seam of a sphere and its smooth neighbours are none.
  const RimmedPart box(Shape(std::make_shared<Shape::Impl>(BRepPrimAPI_MakeBox(10, 20, 30).Solid())));
  double length = 0;
  const Rim sharp(box.model, box.registration, context);
  for (const Rim::Place& p : sharp.places()) {
    CHECK(std::abs(p.inward | p.normal) < 1e-9);
    length += 1e-3 * box.model.diagonal;
  }
  CHECK(length == doctest::Approx(2 * 4 * 60).epsilon(0.02));
}

TEST_CASE("fit_to_rim: points that slid over the border of a plate come back to the middle of where it lets them") {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    CAPTURE(seed);
    const std::vector<Vec3> points = scan(0, width, 3000, 300, seed);
    for (const Vec3& slid : {Vec3(0, 0, 0), Vec3(0.8, -0.5, 0), Vec3(-2, 1, 0)}) {
      const RimFit fit = settled(plate(), points, motion({0, 0, 0.01 * slid[0]}, to_eigen(slid), {50, 30, 0}));
      CHECK(fit.motions == 3);
      // The outermost of n points of a side is 1/n of the width off it in the mean; the mean of two such gaps, and the
      // spread that the noise leaves, stay well below four of them.
      double worst = 0;
      for (const Vec3& p : {Vec3(0, 0, 0), Vec3(width, 0, 0), Vec3(0, height, 0), Vec3(width, height, 0)})
        worst = std::max(worst, (fit.pose(p) - p).norm());
      CHECK(worst < 4 * width / 3000 + 2 * rim_noise);
      CHECK(std::abs(fit.pose(Vec3(50, 30, 0))[2]) < 1e-9);
    }
  }
}

TEST_CASE("fit_to_rim: where the scan ends before the border does, nothing is centred and nothing hangs over") {
  const std::vector<Vec3> points = scan(20, 70, 3000, 0, 7);
  const Pose away = motion({0, 0, 0}, {3, 0, 0}, {0, 0, 0});
  // Free to slide along x: it stays where it is, and across it goes to the middle.
  const RimFit kept = settled(plate(), points, away);
  CHECK(kept.pose.translation[0] == doctest::Approx(3).epsilon(0.02));
  CHECK(std::abs(kept.pose(Vec3(50, 30, 0))[1] - 30) < 4 * height / 3000 + 2 * rim_noise);
  // Over the border by 5: it comes back until it does not hang over, and no farther.
  const RimFit drawn = settled(plate(), points, motion({0, 0, 0}, {35, 0, 0}, {0, 0, 0}));
  CHECK(drawn.pose.translation[0] == doctest::Approx(30).epsilon(0.01));
}

TEST_CASE("align: a cap of a sphere turns under its rim until nothing hangs over") {
  const RimmedPart part(example_part("sphere-cap"));
  RandomStream random(3);
  for (int test = 0; test < 6; ++test) {
    // Evenly over the cap by the height, which on a sphere is even over the area.
    std::vector<Vec3> points;
    const Pose away =
        motion({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)}, {30, -200, 50}, {0, 0, 0});
    for (int i = 0; i < 3000; ++i) {
      const double z = 50 * random.uniform(0.5, 1), angle = 2 * std::numbers::pi * random.uniform();
      const double r = std::sqrt(50.0 * 50.0 - z * z), scale = 1 + rim_noise / 50 * random.normal();
      points.push_back(away(Vec3(r * std::cos(angle), r * std::sin(angle), z) * scale));
    }
    for (int i = 0; i < 300; ++i)
      points.push_back(away(Vec3(random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(0, 70))));
    Context context;
    const AlignResult r = align(part.model, part.registration, points, {}, {}, context);
    CHECK(r.status == AlignStatus::ambiguous);
    // The axis of the cap goes where it was: 3000 points leave it about pi r / (2 n) of freedom.
    const Vec3 axis = (r.pose * away).turn(Vec3(0, 0, 1));
    CHECK(50 * (axis - Vec3(0, 0, 1)).norm() < 6 * std::numbers::pi * 50 / (2 * 3000));
  }
}
