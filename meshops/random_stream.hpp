#pragma once

#include <cstdint>

#include "meshops/vec.hpp"

namespace tri {

/// A number whose every bit depends on every bit of `z`: the finalizer of SplitMix64.
constexpr std::uint64_t mix_bits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Random numbers that are the same on every platform: SplitMix64 [Steele, Lea & Flood 2014], and only operations that
/// IEEE 754 rounds correctly (the standard library's distributions and logarithms differ between platforms).
///
/// Streams with different `stream` or `substream` are independent, so that each point of a parallel loop has its own.
class RandomStream {
 public:
  /// The same three numbers give the same sequence.
  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t substream = 0);

  /// The next 64 random bits.
  std::uint64_t bits();
  /// In [0, 1), a multiple of 2^-53.
  double uniform();
  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count); `count` > 0. The bias is below count / 2^64.
  std::uint64_t below(std::uint64_t count);
  /// Mean 0, standard deviation 1 [Marsaglia & Bray 1964].
  double normal();
  /// Uniform on the unit sphere [Marsaglia 1972].
  Vec3 direction();

 private:
  std::uint64_t state_;
};

}  // namespace tri
