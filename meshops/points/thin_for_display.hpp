#pragma once

#include <cstddef>

#include "meshops/soup.hpp"

namespace tri {

/// A lighter copy of what is too heavy to draw; never for measuring.
///
/// Points (a soup without triangles) are thinned to exactly `most`, every n-th in their order. The vertices of
/// triangles are gathered in the cells of a cubic grid [Rossignac & Borrel 1993] that is widened until at most `most`
/// triangles are left; each cell is stood for by its vertex nearest to the mean, with its own attributes. Triangles
/// within one cell go, as do repetitions; attributes of triangles are not kept.
/// @param most  > 0
/// @return a copy of `soup` if it is light enough
/// @throws InvalidInput if `most` is 0
Soup thin_for_display(const Soup& soup, std::size_t most);

}  // namespace tri
