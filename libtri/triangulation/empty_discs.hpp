#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libtri/registration.hpp"
#include "meshops/search/nearest_points.hpp"

namespace tri {

/// Of unit vectors.
inline double cosine(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Distance from places on the model to the nearest measured point that does not face the other way, and to free edges.
class EmptyDiscs {
 public:
  /// @param feet    of all points; referred to
  /// @param probes  places of the kind that will be asked for
  /// @param reach   mm: points farther than this from every one of `probes` are only looked at where nothing else is
  ///                found
  /// @param step    mm, between the places that stand for a free edge
  EmptyDiscs(const CadModel& model, std::span<const Foot> feet, std::span<const Foot> probes, double reach, double step,
             const Context& context);

  /// What ends the largest disc about a place.
  struct End {
    double distance = 0;
    Vec3 place{0, 0, 0};
    std::int32_t point = -1;  ///< -1 at a free edge, or where nothing ends it
  };
  /// For each of the places, on the threads of the caller's arena; nothing for those without a face.
  std::vector<End> ends(std::span<const Foot> places, const Context& context);

 private:
  using Normal = std::array<float, 3>;

  struct Bin {  // of points with similar normals
    std::vector<Vec3> places;
    std::vector<Normal> normals;
    std::vector<std::int32_t> points;
    Normal middle{};
    double spread = 0;  // radians, of the normals about the middle
    Vec3 low{0, 0, 0}, high{0, 0, 0};
    std::unique_ptr<NearestPoints> tree;

    void finish();
    double squared_distance(const Vec3& p) const;  // to the box
  };
  static constexpr int cells = 3;  // along each side of a cube around the directions

  static std::size_t bin_of(const Normal& n);
  template <class Wanted>
  void fill_bins(Wanted wanted, const Context& context);
  /// @return the nearest point that counts, or `nearest` if that is nearer
  End nearest_point(const Foot& at, End nearest) const;
  End end(const Foot& at) const;

  std::span<const Foot> feet_;
  double reach_;
  double farthest_;
  bool few_;
  std::array<Bin, 6 * cells * cells> bins_;
  std::vector<Vec3> rim_;
  std::optional<NearestPoints> rim_tree_;
};

}  // namespace tri
