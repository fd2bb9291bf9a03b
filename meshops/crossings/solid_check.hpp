#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What keeps triangles from bounding a solid geometrically.
struct SurfaceContacts {
  std::vector<std::uint32_t> flat;                     ///< triangles without area
  std::vector<std::array<std::uint32_t, 2>> crossing;  ///< pairs that meet in more than the corners and sides they
                                                       ///< share
  bool none() const { return flat.empty() && crossing.empty(); }
};

/// Looks for triangles without area and for pairs that meet; vertices in the same place count as the same. Exact.
/// @throws Cancelled
SurfaceContacts surface_contacts(std::span<const Vec3> points, std::span<const Triangle> triangles, Context& context);

/// Vertices that triangles use and that lie in the place of a lower one that triangles use: they touch.
/// @param context  null: cannot be cancelled @throws Cancelled
std::vector<std::uint32_t> touching_vertices(const Soup& soup, const Context* context = nullptr);

/// Whether the triangles, as they are, bound a solid: closed, manifold, coherently oriented, every shell outward or a
/// cavity in another one, without crossings and without triangles that have no area. Exact but for the sign of the
/// volumes. A soup without triangles is none.
/// @param apart  vertices in the same place count as the same also for being manifold, as in a file without indices
/// @throws Cancelled
bool is_clean_solid(const Soup& soup, bool apart, Context& context);

}  // namespace tri
