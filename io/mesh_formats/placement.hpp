#pragma once

#include <array>
#include <cstddef>

#include "meshops/vec.hpp"

namespace tri::io_detail {

/// An affine map of space, p -> L p + t: where a scene (3MF, glTF) puts a mesh.
struct Placement {
  std::array<Vec3, 3> rows{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};  ///< of L
  Vec3 offset = Vec3(0, 0, 0);                                            ///< t

  static Placement scaled(double factor) {
    return {{Vec3(factor, 0, 0), Vec3(0, factor, 0), Vec3(0, 0, factor)}, Vec3(0, 0, 0)};
  }

  /// `second` after `first`.
  friend Placement operator*(const Placement& second, const Placement& first) {
    Placement result;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& row = second.rows[i];
      result.rows[i] = first.rows[0] * row[0] + first.rows[1] * row[1] + first.rows[2] * row[2];
      result.offset[i] = (row | first.offset) + second.offset[i];
    }
    return result;
  }

  /// Stretches every direction by the same factor above 0, and does nothing else.
  bool uniform() const {
    const double s = rows[0][0];
    return s > 0 && rows[0] == Vec3(s, 0, 0) && rows[1] == Vec3(0, s, 0) && rows[2] == Vec3(0, 0, s) &&
           offset == Vec3(0, 0, 0);
  }

  /// Where a point goes. The coordinates of a uniform placement are rounded once at most, and not at all by a factor
  /// of 1.
  Vec3 point(const Vec3& p) const {
    if (uniform()) return p * rows[0][0];
    return Vec3(rows[0] | p, rows[1] | p, rows[2] | p) + offset;
  }

  double determinant() const { return rows[0] | (rows[1] % rows[2]); }

  /// Where a unit normal goes: to unit length; as it is if the placement is uniform, has no volume, or the normal no
  /// length.
  Vec3 normal(const Vec3& n) const {
    const double volume = determinant();
    if (uniform() || volume == 0) return n;
    // The cofactors are the inverse transposed, up to the determinant, of which the sign matters.
    const Vec3 c0 = rows[1] % rows[2], c1 = rows[2] % rows[0], c2 = rows[0] % rows[1];
    const Vec3 turned = Vec3(c0 | n, c1 | n, c2 | n) * (volume > 0 ? 1.0 : -1.0);
    const double length = turned.norm();
    return length > 0 ? turned / length : n;
  }

  friend bool operator==(const Placement&, const Placement&) = default;
};

/// How many elements the copies of meshes that a file of `bytes` bytes asks for may have in all. Files that name one
/// mesh over and over, level within level, would otherwise ask for any amount of memory.
inline std::size_t instance_budget(std::size_t bytes) {
  return 1'000'000 + 64 * bytes;
}

}  // namespace tri::io_detail
