#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Triangles of which patches are taken out and others put in: who is beside whom, and who is in the way. Points in one
/// place are one vertex, named by the lowest of them. For one thread.
class PatchedTriangles {
 public:
  static constexpr std::uint32_t none = 0xffffffff;  ///< in place of a triangle

  /// Copies what it needs. O(n log n) of n triangles.
  /// @param context  null: cannot be cancelled @throws Cancelled
  explicit PatchedTriangles(const Soup& soup, const Context* context = nullptr);

  /// Number of triangles ever, those that were taken out among them; the soup's own come first.
  std::uint32_t size() const { return static_cast<std::uint32_t>(triangles_.size()); }
  /// How many of them are the soup's own.
  std::uint32_t given() const { return given_; }
  /// Whether it was not taken out.
  bool there(std::uint32_t t) const { return there_[t] != 0; }
  /// Its corners.
  const Triangle& corners(std::uint32_t t) const { return triangles_[t]; }
  /// Where they are.
  std::array<Vec3, 3> places(std::uint32_t t) const { return places(triangles_[t]); }
  std::array<Vec3, 3> places(const Triangle& t) const { return {points_[t[0]], points_[t[1]], points_[t[2]]}; }
  /// Where a vertex is.
  const Vec3& point(std::uint32_t vertex) const { return points_[vertex]; }

  /// Takes a triangle out, or puts one back that was.
  void take_out(std::uint32_t t) { there_[t] = 0; }
  void put_back(std::uint32_t t) { there_[t] = 1; }
  /// Adds a triangle. @return its number
  std::uint32_t add(const Triangle& corners);
  /// Takes those with this number and above away for good, which were added last.
  void forget_from(std::uint32_t first);

  /// The triangle beyond side k of one (from corner k to the next), if exactly two are there and run along it in
  /// opposite directions; else `none`.
  std::uint32_t beyond(std::uint32_t t, std::size_t k) const;
  /// Calls `visit(t)` for each triangle there with this corner.
  template <class Visit>
  void at_vertex(std::uint32_t vertex, Visit visit) const {
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i)
      if (there_[around_[i]]) visit(around_[i]);
    if (const auto more = added_around_.find(vertex); more != added_around_.end())
      for (const std::uint32_t t : more->second)
        if (there_[t]) visit(t);
  }

  /// How many triangles there a further one would meet in more than the corners or the side that they share; 0 if it
  /// has no area. Exact.
  int crossings(const Triangle& corners) const;

 private:
  struct Level {
    std::uint32_t first, end;
    OverlapTree tree;
  };
  Level level_of(std::uint32_t first, std::uint32_t end) const;

  const Context* context_;
  std::vector<Vec3> points_;
  std::vector<Triangle> triangles_;
  std::vector<char> there_;
  std::uint32_t given_ = 0;
  std::vector<std::uint32_t> first_, around_;  ///< of each vertex: the given triangles
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> added_around_;
  /// Consecutive numbers: the given ones, then added ones, each level at least twice as large as the next; the rest of
  /// the added ones is in none.
  std::vector<Level> levels_;
};

}  // namespace tri
