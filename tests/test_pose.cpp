#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "libtri/alignment/pose.hpp"
#include "meshops/error.hpp"
#include "meshops/random_stream.hpp"

using namespace tri;

namespace {

Pose random_pose(std::uint64_t seed) {
  RandomStream random(seed);
  const Eigen::Vector3d axis = to_eigen(random.direction());
  return motion(axis * random.uniform(0, std::numbers::pi), to_eigen(random.direction()) * 50, {1, 2, 3});
}

}  // namespace

TEST_CASE("pose: the inverse takes every point back, products apply the right factor first") {
  const Pose a = random_pose(1), b = random_pose(2);
  const Vec3 p(3, -4, 5);
  CHECK((a.inverse()(a(p)) - p).norm() < 1e-12);
  CHECK(((a * b)(p)-a(b(p))).norm() < 1e-12);
  CHECK(Pose().is_identity());
  CHECK_FALSE(a.is_identity());
}

TEST_CASE("pose_of: a matrix comes back as it was, and mirrors, scales and shears are refused") {
  const Pose a = random_pose(3);
  const Pose back = pose_of(a.matrix());
  CHECK((back.rotation - a.rotation).cwiseAbs().maxCoeff() < 1e-15);
  CHECK(back.translation == a.translation);
  auto m = Pose().matrix();
  m[0][0] = -1;
  CHECK_THROWS_AS(pose_of(m), InvalidInput);
  m[0][0] = 1.01;
  CHECK_THROWS_AS(pose_of(m), InvalidInput);
  m[0][0] = 1;
  m[0][1] = 0.01;
  CHECK_THROWS_AS(pose_of(m), InvalidInput);
  m[0][1] = 0;
  m[3][0] = 1;
  CHECK_THROWS_AS(pose_of(m), InvalidInput);
  m[3][0] = std::nan("");
  CHECK_THROWS_AS(pose_of(m), InvalidInput);
}

TEST_CASE("fit_pose: finds the motion between pairs, also of a plane's points, and never mirrors") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Pose truth = random_pose(seed);
    RandomStream random(seed, 1);
    std::vector<Vec3> from, to;
    for (int i = 0; i < 5; ++i) {
      from.push_back(random.direction() * 10);
      if (seed % 2 == 0) from.back()[2] = 0;
      to.push_back(truth(from.back()));
    }
    const Pose pose = fit_pose(from, to);
    CHECK((pose.rotation - truth.rotation).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((pose.translation - truth.translation).norm() < 1e-11);
    // A mirror image has no motion; the nearest rotation is still one.
    for (Vec3& p : to) p[0] = -p[0];
    CHECK(fit_pose(from, to).rotation.determinant() == doctest::Approx(1));
  }
}

TEST_CASE("fit_pose: pairs of weight zero do not count") {
  const Pose truth = random_pose(7);
  std::vector<Vec3> from{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, to;
  for (const Vec3& p : from) to.push_back(truth(p));
  to[3] += Vec3(5, 5, 5);
  const std::vector<double> weights{1, 2, 3, 0};
  CHECK((fit_pose(from, to, weights).rotation - truth.rotation).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("fit_pose: too few pairs, pairs on a line and pairs in one place are refused") {
  const std::vector<Vec3> two{{0, 0, 0}, {1, 0, 0}}, line{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, place(3, Vec3(1, 2, 3)),
      triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  CHECK_THROWS_AS(fit_pose(two, two), InvalidInput);
  CHECK_THROWS_AS(fit_pose(line, triangle), InvalidInput);
  CHECK_THROWS_AS(fit_pose(triangle, line), InvalidInput);
  CHECK_THROWS_AS(fit_pose(place, place), InvalidInput);
  CHECK_THROWS_AS(fit_pose(triangle, two), InvalidInput);
}

TEST_CASE("parts_of: angle, axis, place and slide make up the motion again") {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Pose pose = random_pose(seed);
    const MotionParts parts = parts_of(pose, Vec3(4, 5, 6));
    const Pose again = motion(parts.axis * parts.angle, parts.axis * parts.slide, parts.place);
    CHECK((again.rotation - pose.rotation).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((again.translation - pose.translation).norm() < 1e-9);
  }
}

TEST_CASE("in_words: half turns, signed turns, screws and shifts are named as a person says them") {
  const Vec3 centre(0, 0, 0);
  CHECK(in_words(motion({0, 0, std::numbers::pi}, {0, 0, 0}, {10, 5, 0}), centre, 100) ==
        "turned by 180 degrees about (0, 0, 1) through (10, 5, 0)");
  CHECK(in_words(motion({0, -std::numbers::pi / 2, 0}, {0, 0, 0}, {0, 0, 0}), centre, 100) ==
        "turned by -90 degrees about (0, 1, 0) through (0, 0, 0)");
  CHECK(in_words(motion({std::numbers::pi, 0, 0}, {7, 0, 0}, {0, 0, 0}), centre, 100) ==
        "turned by 180 degrees about (1, 0, 0) through (0, 0, 0) and moved by 7 mm along it");
  CHECK(in_words(motion({0, 0, 0}, {0, 2, 0}, {0, 0, 0}), centre, 100) == "moved by (0, 2, 0) mm");
}
