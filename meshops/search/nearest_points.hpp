#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A k-d tree over points: who is nearest. Built once, queried from any thread.
class NearestPoints {
 public:
  /// A point that was found.
  struct Neighbor {
    std::uint32_t index = 0;      ///< among the points the tree was made of
    double squared_distance = 0;  ///< from the place asked for
  };

  /// @param points  finite; must outlive this object
  /// @param context  null: cannot be cancelled while the tree is built @throws Cancelled
  explicit NearestPoints(std::span<const Vec3> points, const Context* context = nullptr);
  ~NearestPoints();
  /// The other one can only be destroyed afterwards.
  NearestPoints(NearestPoints&&) noexcept;

  /// The `k` nearest points of `place` (all, if there are fewer), nearest first; `out` is overwritten.
  void nearest(const Vec3& place, std::size_t k, std::vector<Neighbor>& out) const;

  /// Every point within `radius` of `place`, in no order; `out` is overwritten.
  void within(const Vec3& place, double radius, std::vector<Neighbor>& out) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tri
