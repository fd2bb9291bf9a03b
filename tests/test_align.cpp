// clang-format off: OpenMesh does not compile after OpenCASCADE
#include "libtri/alignment/align.hpp"
// clang-format on

#include <doctest/doctest.h>

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/sampling/virtual_measurement.hpp"
#include "meshops/error.hpp"

using namespace tri;

namespace {

struct Part {
  explicit Part(const Shape& shape_in) : shape(shape_in), model(make_cad_model(shape_in)), registration(model) {}
  Shape shape;
  CadModel model;
  Registration registration;

  VirtualMeasurement measured(const MeasurementOptions& options) const {
    Context context;
    return measure(shape, options, context);
  }
  AlignResult aligned(const std::vector<Vec3>& points, const AlignOptions& options = {}, int threads = 0) const {
    Context context;
    context.threads = threads;
    return align(model, registration, points, {}, options, context);
  }
};

const Part& bracket() {
  static const Part part(example_part("bracket"));
  return part;
}

Pose true_pose(const VirtualMeasurement& m) {
  return pose_of(m.to_model);
}

// The least rms error (mm) that an unbiased pose can have on average [Cramer 1946, Rao 1945]: from the normal equations
// at the truth, without the outliers.
double cramer_rao(const VirtualMeasurement& m, double noise) {
  std::vector<PointResidual> exact;
  for (const TruePoint& t : m.truth) {
    if (t.outlier) continue;
    PointResidual r;
    r.at = t.point;
    r.direction = t.normal;
    exact.push_back(r);
  }
  const std::vector<double> ones(exact.size(), 1);
  const NormalEquations equations(exact, ones);
  const Matrix6 covariance = equations.matrix.inverse() * (noise * noise / equations.weight);
  // A turn moves a point by its distance from the axis; all points together as far as the radius across two axes of
  // three.
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const PointResidual& r : exact) {
    const Eigen::Vector3d d = (to_eigen(r.at) - equations.centre) / equations.radius;
    spread += (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose()) / equations.weight;
  }
  return std::sqrt((covariance.topLeftCorner<3, 3>() * spread).trace() + covariance.bottomRightCorner<3, 3>().trace());
}

// How far the pose takes the points from where the true one takes them, rms in mm.
double pose_error(const VirtualMeasurement& m, const Pose& pose) {
  const Pose truth = true_pose(m);
  double sum = 0;
  for (const Vec3& p : m.points) sum += (pose(p) - truth(p)).sqrnorm();
  return std::sqrt(sum / static_cast<double>(m.points.size()));
}

}  // namespace

TEST_CASE("align: a moved scan with wild points comes back from nothing, about as well as it can") {
  MeasurementOptions o;
  o.points = 2500;
  o.noise = 0.02;
  o.outliers = 0.1;
  o.move = true;
  for (const std::uint64_t seed : {11, 12}) {
    o.seed = seed;
    const VirtualMeasurement m = bracket().measured(o);
    const AlignResult r = bracket().aligned(m.points);
    CHECK_MESSAGE(r.status == AlignStatus::good, (r.reasons.empty() ? "" : r.reasons[0]));
    CHECK(r.searched);
    CHECK_FALSE(r.kept);
    CHECK(pose_error(m, r.pose) < 2.5 * cramer_rao(m, o.noise));
    CHECK(r.quality.inlier_share == doctest::Approx(0.9).epsilon(0.02));
    CHECK(r.information.freedoms.empty());
  }
}

TEST_CASE("align: points that lie on the model stay where they are, bit for bit, whatever their noise") {
  MeasurementOptions o;
  o.points = 3000;
  for (const double noise : {0.0, 0.001, 0.05}) {
    o.noise = noise;
    const AlignResult r = bracket().aligned(bracket().measured(o).points);
    CHECK(r.kept);
    CHECK(r.pose.is_identity());
    CHECK_FALSE(r.searched);
    CHECK(r.status == AlignStatus::good);
  }
}

TEST_CASE("align: points that are off by more than their noise explains are moved") {
  MeasurementOptions o;
  o.points = 3000;
  o.noise = 0.01;
  VirtualMeasurement m = bracket().measured(o);
  const Vec3 shift(0.03, -0.02, 0.02);
  for (Vec3& p : m.points) p += shift;
  const AlignResult r = bracket().aligned(m.points);
  CHECK_FALSE(r.kept);
  CHECK((to_vec(r.pose.translation) + shift).norm() < 0.01);
}

TEST_CASE("align: the pose does not depend on the number of threads") {
  MeasurementOptions o;
  o.points = 1500;
  o.noise = 0.02;
  o.move = true;
  const VirtualMeasurement m = bracket().measured(o);
  const AlignResult one = bracket().aligned(m.points, {}, 1), all = bracket().aligned(m.points);
  CHECK(one.pose.rotation == all.pose.rotation);
  CHECK(one.pose.translation == all.pose.translation);
}

TEST_CASE("align: what a cylinder leaves free is named, and a pose is found all the same") {
  // Half as long as wide, without its ends: it slides and turns.
  const Part part(Shape(std::make_shared<Shape::Impl>(BRepPrimAPI_MakeCylinder(10, 40).Shell())));
  MeasurementOptions o;
  o.points = 2000;
  o.noise = 0.01;
  VirtualMeasurement m = part.measured(o);
  // Only the side.
  std::vector<Vec3> side;
  for (std::size_t i = 0; i < m.points.size(); ++i)
    if (std::abs(m.truth[i].normal[2]) < 0.5 && m.truth[i].point[2] > 10 && m.truth[i].point[2] < 30)
      side.push_back(m.points[i]);
  const AlignResult r = part.aligned(side);
  CHECK(r.status == AlignStatus::ambiguous);
  REQUIRE(r.information.freedoms.size() == 2);
  CHECK(r.information.freedoms[0].kind == Freedom::Kind::slide);
  CHECK(r.information.freedoms[1].kind == Freedom::Kind::turn);
  for (const Freedom& f : r.information.freedoms) CHECK(f.axis[2] == doctest::Approx(1).epsilon(1e-3));
}

TEST_CASE("align: a box fits four ways, and all are listed") {
  const Part part(Shape(std::make_shared<Shape::Impl>(BRepPrimAPI_MakeBox(30, 20, 10).Solid())));
  MeasurementOptions o;
  o.points = 3000;
  o.noise = 0.01;
  o.move = true;
  o.seed = 5;
  const VirtualMeasurement m = part.measured(o);
  const AlignResult r = part.aligned(m.points);
  CHECK(r.status == AlignStatus::ambiguous);
  REQUIRE(r.alternatives.size() == 3);
  double least = pose_error(m, r.pose);
  for (const Alternative& a : r.alternatives) {
    CHECK(parts_of(a.motion, Vec3(15, 10, 5)).angle == doctest::Approx(M_PI).epsilon(1e-3));
    least = std::min(least, pose_error(m, a.pose));
  }
  CHECK(least < 2.5 * cramer_rao(m, o.noise));
}

TEST_CASE("align: a scan of another part fails and says so") {
  MeasurementOptions o;
  o.points = 2000;
  o.noise = 0.02;
  o.move = true;
  const AlignResult r = bracket().aligned(Part(example_part("blade")).measured(o).points);
  CHECK(r.status != AlignStatus::good);
  CHECK_FALSE(r.reasons.empty());
}

TEST_CASE("align: a scan in inches or metres is not forced onto the model, its factor is found") {
  MeasurementOptions o;
  o.points = 2000;
  o.noise = 0.02;
  o.move = true;
  VirtualMeasurement m = bracket().measured(o);
  for (const double factor : {25.4, 1e-3}) {
    std::vector<Vec3> points = m.points;
    for (Vec3& p : points) p /= factor;
    const AlignResult r = bracket().aligned(points);
    CHECK(r.status == AlignStatus::failed);
    CHECK(r.unit_factor == doctest::Approx(factor));
  }
}

TEST_CASE("align: a start is refined from there, or only measured") {
  MeasurementOptions o;
  o.points = 2000;
  o.noise = 0.02;
  o.move = true;
  const VirtualMeasurement m = bracket().measured(o);
  const Pose off = motion({0.003, -0.002, 0.002}, {0.1, 0.1, -0.1}, to_eigen(true_pose(m)(m.points[0])));
  AlignOptions options;
  options.start = off * true_pose(m);
  const AlignResult refined = bracket().aligned(m.points, options);
  CHECK_FALSE(refined.searched);
  CHECK(pose_error(m, refined.pose) < 2.5 * cramer_rao(m, o.noise));
  options.metric = Metric::point;
  CHECK(pose_error(m, bracket().aligned(m.points, options).pose) < 0.5 * o.noise);
  options.mode = AlignMode::none;
  const AlignResult measured = bracket().aligned(m.points, options);
  CHECK(measured.pose.rotation == options.start->rotation);
  CHECK(measured.pose.translation == options.start->translation);
}

TEST_CASE("align: input without a pose is refused with a reason") {
  const std::vector<Vec3> good{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK_THROWS_AS(bracket().aligned({}), InvalidInput);
  CHECK_THROWS_AS(bracket().aligned({good[0], good[1]}), InvalidInput);
  CHECK_THROWS_AS(bracket().aligned({good[0], good[1], good[0], good[1]}), InvalidInput);
  CHECK_THROWS_AS(bracket().aligned({good[0], good[1], {0, std::numeric_limits<double>::quiet_NaN(), 0}}),
                  InvalidInput);
  AlignOptions options;
  options.keep = 0;
  CHECK_THROWS_AS(bracket().aligned(good, options), InvalidInput);
  options.keep = 1;
  options.probe_radius = -1;
  CHECK_THROWS_AS(bracket().aligned(good, options), InvalidInput);
}

TEST_CASE("align: a handful of points, or points on a line or a plane, never make a good pose") {
  std::vector<Vec3> line, plane;
  for (int i = 0; i < 200; ++i) {
    line.emplace_back(0.1 * i, 0.2 * i, 0.05 * i);
    plane.emplace_back(0.1 * (i % 20), 0.2 * (i / 20), 3);
  }
  for (const auto& points : {std::vector<Vec3>{{0, 0, 0}, {9, 0, 0}, {0, 8, 0}}, line, plane})
    CHECK(bracket().aligned(points).status != AlignStatus::good);
}

TEST_CASE("align: a cancelled alignment stops") {
  MeasurementOptions o;
  o.points = 2000;
  o.move = true;
  const VirtualMeasurement m = bracket().measured(o);
  Context context;
  int calls = 0;
  context.threads = 1;
  context.on_checkpoint = [&] {
    if (++calls == 30) context.cancel();
  };
  CHECK_THROWS_AS(align(bracket().model, bracket().registration, m.points, {}, {}, context), Cancelled);
}

TEST_CASE("align: centres of a probe's ball are fitted at its radius from the model") {
  MeasurementOptions o;
  o.points = 3000;
  o.noise = 0.01;
  VirtualMeasurement m = bracket().measured(o);
  // Where the ball would not go into a corner of the bracket, other faces are nearer: not points of a probe.
  const double radius = 1.5;
  std::vector<Vec3> centres;
  Context context;
  for (std::size_t i = 0; i < m.points.size(); ++i) centres.push_back(m.points[i] + m.truth[i].normal * radius);
  const std::vector<Foot> feet = bracket().registration.register_points(centres, context);
  std::vector<Vec3> moved;
  const Pose away = motion({0.5, 1.5, -1}, {30, -40, 20}, {0, 0, 0});
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (feet[i].deviation < radius - 0.1) continue;
    kept.push_back(centres[i]);
    moved.push_back(away(centres[i]));
  }
  AlignOptions options;
  options.probe_radius = radius;
  const AlignResult r = bracket().aligned(moved, options);
  double sum = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) sum += (r.pose(moved[i]) - kept[i]).sqrnorm();
  CHECK(r.status == AlignStatus::good);
  CHECK(std::sqrt(sum / static_cast<double>(kept.size())) < 0.2 * o.noise);
  CHECK(r.quality.rms < 1.2 * o.noise);
  // As they are they lie so far off the model, and stay.
  CHECK(bracket().aligned(kept, options).kept);
}

TEST_CASE("FitTarget: normals tell the side where they agree on it, and do not count where they do not") {
  const FitTarget target{bracket().registration, bracket().model.diagonal, 0};
  MeasurementOptions o;
  o.points = 500;
  const VirtualMeasurement m = bracket().measured(o);
  std::vector<Vec3> normals;
  for (const TruePoint& t : m.truth) normals.push_back(t.normal);
  const auto opposed = [&] {
    Context context;
    std::size_t count = 0;
    for (const PointResidual& r : target.residuals(m.points, normals, Pose(), context)) count += r.opposed;
    return count;
  };
  CHECK(opposed() == 0);
  for (std::size_t i = 0; i < 50; ++i) normals[i] *= -1.0;
  CHECK(opposed() == 50);
  for (Vec3& n : normals) n *= -1.0;
  CHECK(opposed() == 50);
  for (std::size_t i = 0; i < 250; ++i) normals[2 * i] *= -1.0;
  CHECK(opposed() == 0);
}
