#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "libtri/sampling/sampling_model.hpp"
#include "meshops/random_stream.hpp"

namespace tri {

/// A place on the model, before it is evaluated.
struct SurfacePlace {
  std::int32_t face = 0;  ///< 0-based position in SamplingModel::faces()
  Vec2 uv{0, 0};
};

/// Draws places uniformly over the trimmed area: a cell by its area, then (u,v) within it, accepted in proportion to
/// |du x dv|.
class AreaSampler {
 public:
  AreaSampler(const SamplingModel& model, Context& context);
  /// One place that `accept` takes. Gives up after `max_tries` refusals and returns false.
  bool draw(RandomStream& random, const std::function<bool(const SamplingModel::Sample&)>& accept, int max_tries,
            SurfacePlace& place, SamplingModel::Sample& sample) const;
  double area() const { return area_; }  ///< mm^2, to about 1%

 private:
  struct Cell {
    std::uint32_t facet;
    std::array<Vec2, 3> corners;
    double bound;  // of |du x dv| within the cell
  };
  void add(std::uint32_t facet, const std::array<Vec2, 3>& corners, int depth);

  const SamplingModel& model_;
  std::vector<Cell> cells_;
  std::vector<double> cumulative_;
  double area_ = 0;
};

/// Where parallel planes `distance` mm apart cut the model's facets, linked into lines.
class ScanLines {
 public:
  /// `travel`: unit normal of the planes; `second`: of those used where |normal . travel| > 0.8.
  ScanLines(const SamplingModel& model, const Vec3& travel, const Vec3& second, double distance, RandomStream random);
  double length() const { return length_; }      ///< mm, of all lines
  double distance() const { return distance_; }  ///< mm between planes
  /// A place every `spacing` mm along the lines, one after another, from `phase` * spacing on; trimmed places are left
  /// out.
  std::vector<SurfacePlace> places(double spacing, double phase) const;

 private:
  struct Piece {
    std::uint32_t facet;
    Vec2 from, to;
    double length;
  };
  void cut(const Vec3& travel, const std::vector<std::uint32_t>& facets, double distance, RandomStream& random);

  const SamplingModel& model_;
  std::vector<Piece> pieces_;  // in order along the lines
  double length_ = 0, distance_ = 0;
};

/// Cell centres of a regular (u,v) grid on each face, about `spacing` mm apart, at least one row and column a face.
std::vector<SurfacePlace> grid_places(const SamplingModel& model, double spacing);

}  // namespace tri
