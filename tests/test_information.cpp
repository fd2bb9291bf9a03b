#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "libtri/alignment/information.hpp"
#include "meshops/random_stream.hpp"

using namespace tri;

namespace {

PointResidual residual(const Vec3& at, const Vec3& direction) {
  PointResidual r;
  r.at = at;
  r.direction = direction / direction.norm();
  return r;
}

PoseInformation information(const std::vector<PointResidual>& residuals, double sigma = 0.01, double limit = 1e9) {
  const std::vector<double> ones(residuals.size(), 1);
  return information_of(NormalEquations(residuals, ones), sigma, limit);
}

std::vector<PointResidual> plane() {
  std::vector<PointResidual> r;
  for (int i = 0; i < 100; ++i) r.push_back(residual({i % 10 + 3.0, i / 10 * 2.0, 5}, {0, 0, 1}));
  return r;
}

std::vector<PointResidual> cylinder(const Vec3& place) {
  std::vector<PointResidual> r;
  for (int i = 0; i < 200; ++i) {
    const Vec3 d(std::cos(i * 0.7), std::sin(i * 0.7), 0);
    r.push_back(residual(place + d * 4.0 + Vec3(0, 0, 0.1 * i), d));
  }
  return r;
}

}  // namespace

TEST_CASE("information_of: a plane slides two ways and turns about its normal") {
  const PoseInformation info = information(plane());
  REQUIRE(info.freedoms.size() == 3);
  int slides = 0;
  for (const Freedom& f : info.freedoms) {
    if (f.kind == Freedom::Kind::slide) {
      ++slides;
      CHECK(std::abs(f.axis[2]) < 1e-9);
    } else {
      CHECK(f.kind == Freedom::Kind::turn);
      CHECK(f.axis[2] == doctest::Approx(1));
    }
  }
  CHECK(slides == 2);
}

TEST_CASE("information_of: a cylinder slides along its axis and turns about it") {
  const Vec3 place(7, -2, 0);
  const PoseInformation info = information(cylinder(place));
  REQUIRE(info.freedoms.size() == 2);
  CHECK(info.freedoms[0].kind == Freedom::Kind::slide);
  CHECK(info.freedoms[0].in_words() == "slides along (0, 0, 1)");
  CHECK(info.freedoms[1].kind == Freedom::Kind::turn);
  CHECK(info.freedoms[1].axis[2] == doctest::Approx(1));
  CHECK(info.freedoms[1].place[0] == doctest::Approx(7));
  CHECK(info.freedoms[1].place[1] == doctest::Approx(-2));
}

TEST_CASE("information_of: a sphere turns about every axis through its centre") {
  std::vector<PointResidual> r;
  RandomStream random(1);
  const Vec3 centre(1, 2, 3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 d = random.direction();
    if (d[2] > 0) r.push_back(residual(centre + d * 5.0, d));
  }
  const PoseInformation info = information(r);
  REQUIRE(info.freedoms.size() == 1);
  CHECK(info.freedoms[0].kind == Freedom::Kind::swivel);
  for (int k = 0; k < 3; ++k) CHECK(info.freedoms[0].place[k] == doctest::Approx(centre[k]));
}

TEST_CASE("information_of: a helicoid screws along itself") {
  // (r cos t, r sin t, 2 t): its normal is (2 sin t, -2 cos t, r).
  std::vector<PointResidual> r;
  for (int i = 0; i < 400; ++i) {
    const double radius = 1 + i % 10, t = 0.05 * i;
    r.push_back(
        residual({radius * std::cos(t), radius * std::sin(t), 2 * t}, {2 * std::sin(t), -2 * std::cos(t), radius}));
  }
  const PoseInformation info = information(r);
  REQUIRE(info.freedoms.size() == 1);
  CHECK(info.freedoms[0].kind == Freedom::Kind::screw);
  CHECK(info.freedoms[0].axis[2] == doctest::Approx(1));
  CHECK(std::abs(info.freedoms[0].pitch) == doctest::Approx(4 * std::numbers::pi));
}

TEST_CASE("information_of: three planes fix the pose, and the standard deviations are those of least squares") {
  std::vector<PointResidual> r;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 100; ++i) {
      Vec3 p(i % 10 - 4.5, i / 10 - 4.5, -5), n(0, 0, 0);
      p = Vec3(p[(3 - axis) % 3], p[(4 - axis) % 3], p[(5 - axis) % 3]);
      n[(2 + axis) % 3] = 1;
      r.push_back(residual(p, n));
    }
  }
  const double sigma = 0.02;
  const PoseInformation info = information(r, sigma);
  CHECK(info.freedoms.empty());
  CHECK(info.weak.empty());
  // Shifts without turns: 100 points each fix one axis; turns make it worse.
  CHECK(info.standard_deviation > std::sqrt(3) * sigma / 10);
  double sum = 0;
  for (const double e : info.eigenvalues) sum += sigma * sigma / (300 * e);
  CHECK(info.standard_deviation == doctest::Approx(std::sqrt(sum)));
  CHECK(information(r, sigma, 1e-6).weak.size() == 6);
}

TEST_CASE("is_free: motions of a cylinder, and others") {
  const Vec3 place(7, -2, 0), centre(7, -2, 10);
  const auto freedoms = information(cylinder(place)).freedoms;
  const Eigen::Vector3d axis(7, -2, 0);
  CHECK(is_free(Pose(), freedoms, centre, 10, 0.01));
  CHECK(is_free(motion({0, 0, 2}, {0, 0, 3}, axis), freedoms, centre, 10, 0.01));
  CHECK_FALSE(is_free(motion({0, 0, 2}, {0, 0.1, 3}, axis), freedoms, centre, 10, 0.01));
  CHECK_FALSE(is_free(motion({std::numbers::pi, 0, 0}, {0, 0, 0}, to_eigen(centre)), freedoms, centre, 10, 0.01));
  CHECK_FALSE(is_free(motion({0, 0, 2}, {0, 0, 0}, axis), {}, centre, 10, 0.01));
}
