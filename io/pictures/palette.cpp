#include "io/pictures/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tri {
namespace {

template <std::size_t N>
Vec3 between(const std::array<Vec3, N>& anchors, double t) {
  const double x = std::clamp(t, 0.0, 1.0) * (N - 1);
  const auto i = std::min(static_cast<std::size_t>(x), N - 2);
  const double f = x - static_cast<double>(i);
  return anchors[i] * (1 - f) + anchors[i + 1] * f;
}

Vec3 from_hsv(double hue, double saturation, double value) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue * 6, 6.0);
    return value - value * saturation * std::max(0.0, std::min({k, 4 - k, 1.0}));
  };
  return {channel(5), channel(3), channel(1)};
}

}  // namespace

Vec3 category_color(std::int64_t category) {
  // Hues a golden section apart never come close to one another for many steps; three tones tell near hues apart.
  constexpr double golden = 0.6180339887498949;
  constexpr std::array<std::array<double, 2>, 3> tones{{{0.55, 0.92}, {0.75, 0.75}, {0.35, 0.98}}};
  const auto n = static_cast<std::uint64_t>(category) % 360;
  const auto& tone = tones[n % tones.size()];
  return from_hsv(std::fmod(0.58 + golden * static_cast<double>(n), 1.0), tone[0], tone[1]);
}

Vec3 diverging_color(double t) {
  static const std::array<Vec3, 5> anchors{Vec3(0.13, 0.33, 0.67), Vec3(0.50, 0.68, 0.86), Vec3(0.95, 0.95, 0.93),
                                           Vec3(0.93, 0.58, 0.46), Vec3(0.72, 0.11, 0.16)};
  return between(anchors, 0.5 + 0.5 * t);
}

Vec3 sequential_color(double t) {
  static const std::array<Vec3, 5> anchors{Vec3(0.27, 0.00, 0.33), Vec3(0.23, 0.32, 0.55), Vec3(0.13, 0.57, 0.55),
                                           Vec3(0.37, 0.79, 0.38), Vec3(0.99, 0.91, 0.14)};
  return between(anchors, t);
}

Vec3 deviation_color(double value, const DeviationScale& scale) {
  if (std::isnan(value)) return missing_color();
  if (scale.tolerance && value < scale.low) return {0.00, 0.74, 0.80};
  if (scale.tolerance && value > scale.high) return {0.85, 0.00, 0.62};
  const double neutral = scale.low < 0 && scale.high > 0 ? 0 : 0.5 * (scale.low + scale.high);
  return diverging_color((value - neutral) / (value < neutral ? neutral - scale.low : scale.high - neutral));
}

}  // namespace tri
