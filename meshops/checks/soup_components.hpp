#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "meshops/checks/shells.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// A set of triangles joined over edges, of however many triangles.
struct SoupComponent {
  std::uint64_t triangles = 0;  ///< how many
  double area = 0;              ///< their sum
  double volume = 0;            ///< enclosed by its closed shells as they are oriented in the majority; signed
  double absolute_volume = 0;   ///< the same, each shell taken as positive
  bool closed = true;           ///< every shell of it is closed
};

/// @param component_of_triangle as `MeshPlaces` has it
/// @param shells of the same soup
/// @param context null: cannot be cancelled
/// @return by number of component. O(triangles)
/// @throws Cancelled
std::vector<SoupComponent> measure_components(const Soup& soup, std::span<const std::uint32_t> component_of_triangle,
                                              const Shells& shells, const Context* context = nullptr);

}  // namespace tri
