#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "libtri/alignment/fit_quality.hpp"
#include "libtri/alignment/verdict.hpp"
#include "meshops/random_stream.hpp"

using namespace tri;

namespace {

constexpr double sigma = 0.01, diagonal = 100;

// A grid of points on a plane with Gaussian deviations.
struct Field {
  Field() {
    RandomStream random(1);
    for (int i = 0; i < 2500; ++i) {
      PointResidual r;
      r.at = Vec3(i % 50, i / 50, 0);
      r.face = 0;
      r.value = sigma * random.normal();
      residuals.push_back(r);
    }
  }
  FitQuality quality() const {
    std::vector<Vec3> points;
    for (const PointResidual& r : residuals) points.push_back(r.at);
    return fit_quality(residuals, neighbourhood(points, Context()), diagonal);
  }
  std::vector<PointResidual> residuals;
};

}  // namespace

TEST_CASE("neighbourhood: the four nearest others, and none that is far away") {
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.emplace_back(i % 10, i / 10, 0);
  points.emplace_back(50, 50, 50);
  const Neighbourhood n = neighbourhood(points, Context());
  std::vector<std::uint32_t> four(n[55].begin(), n[55].end());
  std::sort(four.begin(), four.end());
  CHECK(four == std::vector<std::uint32_t>{45, 54, 56, 65});
  for (const std::uint32_t k : n[100]) CHECK(k == 100);
}

TEST_CASE("fit_quality: noise is noise: its standard deviation, no correlation, nothing coherent") {
  const FitQuality q = Field().quality();
  CHECK(q.sigma == doctest::Approx(sigma).epsilon(0.06));
  CHECK(q.rms == doctest::Approx(sigma).epsilon(0.06));
  CHECK(q.inlier_share > 0.999);
  CHECK(q.near_share == 1);
  CHECK(q.coherent_share == 0);
  CHECK(q.correlation < 0.1);
  CHECK(q.systematic < 0.4 * sigma);
  CHECK(fits(q, diagonal));
}

TEST_CASE("fit_quality: wild points here and there are outliers and no misfit") {
  Field field;
  RandomStream random(2);
  for (int i = 0; i < 250; ++i) field.residuals[random.below(2500)].value = 5 * random.normal();
  const FitQuality q = field.quality();
  CHECK(q.inlier_share < 0.93);
  CHECK(q.coherent_share < 0.005);
  CHECK(fits(q, diagonal));
}

TEST_CASE("fit_quality: a region that lies off the model as a whole is told from wild points") {
  Field field;
  for (PointResidual& r : field.residuals)
    if (r.at[0] < 5) r.value += 0.5;
  const FitQuality q = field.quality();
  CHECK(q.coherent_share == doctest::Approx(0.1).epsilon(0.1));
  CHECK_FALSE(fits(q, diagonal));
}

TEST_CASE("fit_quality: a wave of the whole surface is systematic") {
  Field field;
  for (PointResidual& r : field.residuals) r.value += 0.3 * std::sin(0.2 * r.at[0]);
  const FitQuality q = field.quality();
  CHECK(q.systematic == doctest::Approx(0.3 / std::sqrt(2)).epsilon(0.1));
  CHECK(q.correlation > 0.9);
  CHECK_FALSE(fits(q, diagonal));
}
