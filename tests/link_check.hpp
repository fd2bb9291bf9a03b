#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "meshops/soup.hpp"

namespace tri::test {

/// What is wrong with triangles linked by neighbours, and their topology, counted without the code under test.
struct LinkedTriangles {
  /// One sentence each, at most ten: links that do not answer each other along the same edge, vertices with two fans,
  /// repeated vertices in a triangle.
  std::vector<std::string> problems;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> double_edges;  ///< vertex pairs joined by more than one edge
  std::set<std::uint32_t> vertices;                                   ///< in at least one triangle
  long components = 0, loops = 0, euler = 0;
};

/// Triangles whose first two vertices are equal are taken as deleted.
/// @param neighbors  triangle across the edge opposite each corner; -1 on the boundary
LinkedTriangles check_links(const std::vector<Triangle>& triangles,
                            const std::vector<std::array<std::int32_t, 3>>& neighbors);

}  // namespace tri::test

/// Fails with the list of problems if links are broken or a vertex has two fans.
#define CHECK_LINKS(linked)                                                   \
  do {                                                                        \
    for (const std::string& problem : (linked).problems) FAIL_CHECK(problem); \
  } while (false)
