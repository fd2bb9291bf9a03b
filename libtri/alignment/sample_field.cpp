#include "libtri/alignment/sample_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "meshops/limits.hpp"

namespace tri {
SampleField::SampleField(const SurfaceSamples& samples, double margin, std::size_t cells) {
  Vec3 low = samples.points[0], high = low;
  for (const Vec3& p : samples.points) {
    low.minimize(p);
    high.maximize(p);
  }
  low -= Vec3(margin);
  high += Vec3(margin);
  centre_ = (low + high) * 0.5;
  const Vec3 extent = high - low;
  cell_ = std::cbrt(extent[0] * extent[1] * extent[2] / static_cast<double>(cells));
  scale_ = static_cast<float>(1 / cell_);
  for (int k = 0; k < 3; ++k) {
    low_[static_cast<std::size_t>(k)] = static_cast<float>(low[k] - centre_[k]);
    size_[static_cast<std::size_t>(k)] = std::max(1, static_cast<int>(std::ceil(extent[k] / cell_)));
  }
  samples_.reserve(samples.points.size());
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    Sample s;
    for (int k = 0; k < 3; ++k) {
      s.point[static_cast<std::size_t>(k)] = static_cast<float>(samples.points[i][k] - centre_[k]);
      s.normal[static_cast<std::size_t>(k)] = static_cast<float>(samples.normals[i][k]);
    }
    samples_.push_back(s);
  }

  const int nx = size_[0], ny = size_[1], nz = size_[2];
  const auto index = [&](int x, int y, int z) { return (static_cast<std::size_t>(z) * ny + y) * nx + x; };
  nearest_.assign(static_cast<std::size_t>(nx) * ny * nz, no_index);
  std::vector<float> best(nearest_.size(), std::numeric_limits<float>::max());
  const float h = static_cast<float>(cell_);
  const auto offer = [&](std::size_t at, int x, int y, int z, std::uint32_t sample) {
    const Sample& s = samples_[sample];
    const float a = low_[0] + h * (static_cast<float>(x) + 0.5f) - s.point[0];
    const float b = low_[1] + h * (static_cast<float>(y) + 0.5f) - s.point[1];
    const float c = low_[2] + h * (static_cast<float>(z) + 0.5f) - s.point[2];
    const float d = a * a + b * b + c * c;
    if (d < best[at]) {
      best[at] = d;
      nearest_[at] = sample;
    }
  };
  for (std::uint32_t i = 0; i < samples_.size(); ++i) {
    int at[3];
    for (int k = 0; k < 3; ++k)
      at[k] = std::clamp(
          static_cast<int>((samples_[i].point[static_cast<std::size_t>(k)] - low_[static_cast<std::size_t>(k)]) / h), 0,
          size_[static_cast<std::size_t>(k)] - 1);
    offer(index(at[0], at[1], at[2]), at[0], at[1], at[2], i);
  }
  // The 13 neighbours that come before a cell, then the 13 that come after it; the second round mends what the first
  // could not reach.
  for (int round = 0; round < 2; ++round) {
    for (const int direction : {1, -1}) {
      for (int z0 = 0; z0 < nz; ++z0) {
        const int z = direction > 0 ? z0 : nz - 1 - z0;
        for (int y0 = 0; y0 < ny; ++y0) {
          const int y = direction > 0 ? y0 : ny - 1 - y0;
          for (int x0 = 0; x0 < nx; ++x0) {
            const int x = direction > 0 ? x0 : nx - 1 - x0;
            const std::size_t at = index(x, y, z);
            for (int k = 0; k < 13; ++k) {
              const int ox = x + direction * (k % 3 - 1), oy = y + direction * (k / 3 % 3 - 1),
                        oz = z + direction * (k / 9 - 1);
              if (ox < 0 || oy < 0 || oz < 0 || ox >= nx || oy >= ny || oz >= nz) continue;
              const std::uint32_t sample = nearest_[index(ox, oy, oz)];
              if (sample != no_index && sample != nearest_[at]) offer(at, x, y, z, sample);
            }
          }
        }
      }
    }
  }
}

}  // namespace tri
