#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libtri/alignment/surface_samples.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A grid of cells that know a sample of the model near them: for some hundred thousand rough distances a tenth of a
/// second.
///
/// The samples are spread from cell to cell [Danielsson 1980]; what a cell names is the sample nearest to its centre or
/// one hardly farther. Immutable; may be shared between threads.
class SampleField {
 public:
  struct Sample {
    std::array<float, 3> point, normal;  ///< relative to `centre()`
  };

  /// @param margin  mm, that the grid reaches beyond the samples; places farther away are answered from its rim
  /// @param cells   about so many
  SampleField(const SurfaceSamples& samples, double margin, std::size_t cells);

  const Vec3& centre() const { return centre_; }
  double cell() const { return cell_; }  ///< mm
  /// @param p  relative to `centre()`
  const Sample& near(const float p[3]) const {
    std::size_t at = 0;
    for (int k = 2; k >= 0; --k) {
      const float x = (p[k] - low_[k]) * scale_;
      const int i = x > 0 ? (x < static_cast<float>(size_[k]) ? static_cast<int>(x) : size_[k] - 1) : 0;
      at = at * static_cast<std::size_t>(size_[k]) + static_cast<std::size_t>(i < size_[k] ? i : size_[k] - 1);
    }
    return samples_[nearest_[at]];
  }

 private:
  std::vector<Sample> samples_;
  std::vector<std::uint32_t> nearest_;
  Vec3 centre_{0, 0, 0};
  std::array<float, 3> low_{};
  std::array<int, 3> size_{};
  float scale_ = 1;
  double cell_ = 1;
};

}  // namespace tri
