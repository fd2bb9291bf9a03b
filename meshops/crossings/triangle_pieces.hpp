#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/report.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// Triangles that take the place of all triangles of a soup.
struct TrianglePieces {
  struct Piece {
    Triangle v;       ///< indices into `places`
    Triangle within;  ///< vertices of the soup: the triangle whose plane it lies in, for the attributes of new vertices
    std::uint32_t source;  ///< triangle of the soup, for the attributes of the piece
  };

  std::vector<Piece> triangles;
  std::vector<Vec3> places;             ///< of vertices
  std::vector<std::uint32_t> original;  ///< of vertices: that of the soup which it is, or is a copy of; or none
                                        ///< (0xffffffff)
};

/// Replaces the triangles of a soup. A triangle that is there as before keeps its place, a vertex its number;
/// attributes are kept, copied or interpolated. Vertices that no triangle uses go.
///
/// @return of each triangle of the result: its piece
/// @throws Cancelled; the soup is then half done
/// Counts: `vertices_added`, `vertices_moved`, `vertices_removed`, `faces_added`, `faces_removed`, `touched_faces`: all
/// new ones.
std::vector<std::uint32_t> replace_by_pieces(Soup& soup, const TrianglePieces& pieces, Report& report,
                                             const Context& context);

}  // namespace tri
