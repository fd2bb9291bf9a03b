#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A set of triangles that are joined over edges of two triangles.
struct Shell {
  std::vector<std::uint32_t> triangles;  ///< increasing
  std::uint64_t reversed = 0;            ///< of these, triangles that have to be turned around to agree with the others
  /// Every edge has, among these triangles turned as said, as many that run along it one way as the other.
  bool closed = false;
  double area = 0;    ///< of all its triangles
  double volume = 0;  ///< enclosed by the triangles turned as said, negative if inside out; 0 unless closed
  int depth = 0;      ///< number of other closed shells around it; 0 unless closed and `find_depths` was called
  int winding = 0;    ///< how often those wind round it: outward ones count 1, others -1
};

/// The shells of a soup and the orientation in which the triangles of each agree.
struct Shells {
  static constexpr std::uint32_t none = 0xffffffff;  ///< in place of the index of a shell
  std::vector<Shell> shells;                         ///< in the order of their first triangles
  std::vector<std::uint32_t> of_triangle;            ///< `none` for a triangle that names a vertex twice
  std::vector<char> reversed;  ///< 1: the triangle has to be turned; the majority of each shell stays
  /// Edges of two triangles that run the same way even so: the shell has only one side (a Moebius strip).
  std::vector<std::array<std::uint32_t, 2>> one_sided;
};

/// O(triangles). Of two orientations that need as many triangles turned, the one of the first triangle is taken. Exact
/// copies of a triangle are not taken for its neighbours.
Shells find_shells(const Soup& soup, Context& context);

/// Sets `depth` and `winding`: a closed shell lies in another if its box lies in the other's, none of its vertices is
/// outside of the other and one is inside, which is decided exactly.
void find_depths(const Soup& soup, Shells& shells, Context& context);

/// Whether a shell, turned as said, has less than nothing inside: it faces inward and is no cavity of a solid around
/// it. One that faces outward never is: within another solid it is a solid too, as of a second material, or a cavity
/// that someone meant, which no one can tell.
inline bool is_inside_out(const Shell& shell) {
  return shell.volume < 0 && shell.winding <= 0;
}

/// Whether places are inside of closed triangles.
class InsideTest {
 public:
  /// Where a place lies; `on`: on a triangle, exactly.
  enum class Where { outside, inside, on };

  /// @param listed indices of triangles; each of their edges has an even number of them. The soup must outlive this
  /// object.
  /// @param context null: cannot be cancelled @throws Cancelled
  InsideTest(const Soup& soup, std::span<const std::uint32_t> listed, const Context* context = nullptr);

  /// Inside is what an odd number of triangles lies before, seen along an axis. Exact for any finite coordinates: where
  /// the line meets an edge, the place counts as moved by an infinitely small amount [Edelsbrunner & Muecke 1990].
  Where locate(const Vec3& place) const;

 private:
  const Soup& soup_;
  std::vector<std::uint32_t> listed_;
  OverlapTree tree_;  // of places in `listed_`
};

}  // namespace tri
