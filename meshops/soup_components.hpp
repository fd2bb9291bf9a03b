#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/shells.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A set of triangles joined over edges, of however many triangles.
struct SoupComponent {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;  ///< that its triangles name
  double area = 0;
  double volume = 0;    ///< the sum of the volumes of its closed shells, as they are oriented in the majority; signed
  bool closed = false;  ///< every shell of it is closed
};

struct SoupComponents {
  std::vector<SoupComponent> components;       ///< in the order of their first triangles
  std::vector<std::uint32_t> of_triangle;
};

/// O(triangles). A triangle that names a vertex twice is joined to others over its one edge.
/// @param shells of the same soup
SoupComponents find_components(const Soup& soup, const Shells& shells, Context& context);

}  // namespace tri
