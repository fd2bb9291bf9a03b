#include "meshops/random_stream.hpp"

#include <cmath>

namespace tri {
namespace {

constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ULL;

// The natural logarithm of x > 0 by the series of atanh.
double logarithm(double x) {
  int exponent;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752) {
    m *= 2;
    --exponent;
  }
  const double z = (m - 1) / (m + 1), zz = z * z;
  double sum = 0;
  for (int k = 23; k >= 1; k -= 2) sum = sum * zz + 1.0 / k;
  return 2 * z * sum + exponent * 0.69314718055994531;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream, std::uint64_t substream)
    : state_(mix_bits(mix_bits(mix_bits(seed + golden) + stream + golden) + substream + golden)) {}

std::uint64_t RandomStream::bits() {
  return mix_bits(state_ += golden);
}

double RandomStream::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1p-53;
}

std::uint64_t RandomStream::below(std::uint64_t count) {
  // The high word of a 64 x 64 bit product, from 32-bit halves.
  const std::uint64_t x = bits(), x0 = x & 0xffffffffULL, x1 = x >> 32, c0 = count & 0xffffffffULL, c1 = count >> 32;
  const std::uint64_t middle = x1 * c0 + ((x0 * c0) >> 32), carry = (middle & 0xffffffffULL) + x0 * c1;
  return x1 * c1 + (middle >> 32) + (carry >> 32);
}

double RandomStream::normal() {
  for (;;) {
    const double a = uniform(-1, 1), b = uniform(-1, 1), s = a * a + b * b;
    if (s > 0 && s < 1) return a * std::sqrt(-2 * logarithm(s) / s);
  }
}

Vec3 RandomStream::direction() {
  for (;;) {
    const double a = uniform(-1, 1), b = uniform(-1, 1), s = a * a + b * b;
    if (s < 1) return {2 * a * std::sqrt(1 - s), 2 * b * std::sqrt(1 - s), 1 - 2 * s};
  }
}

}  // namespace tri
