#pragma once

#include <string>
#include <vector>

#include "meshops/mesh_view.hpp"

namespace tri::test {

/// Everything wrong with a half-edge structure, one sentence each and at most twenty; empty for a valid mesh.
///
/// Elements marked as deleted are skipped, but nothing that stays may refer to one. Valid means: half-edges in closed
/// `next` cycles with matching `prev`, three per face; both ends of an edge differ; no two edges join the same
/// vertices; no edge without a face; every vertex has one fan, and stores a boundary half-edge if it is on the
/// boundary. Written against the raw links only: no circulator, nothing of meshops.
std::vector<std::string> mesh_problems(const OpenMesh::TriConnectivity& mesh);

/// All links, status bits and positions of a mesh: two snapshots are equal only if the meshes are equal bit for bit.
struct Snapshot {
  std::vector<int> links;
  std::vector<unsigned> status;
  std::vector<double> coordinates;

  bool operator==(const Snapshot&) const = default;
};
Snapshot snapshot(MeshView view);

/// A mesh made with OpenMesh's own `add_face`; the test fails if a face is refused.
Mesh make_mesh(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& triangles);

/// Inputs that several tests share. All are oriented counter-clockwise seen from outside or above.
Mesh icosahedron();                ///< closed, 20 equilateral faces
Mesh grid(int columns, int rows);  ///< (columns + 1) x (rows + 1) vertices in z = 0, spacing 1, two faces per cell
Mesh bumpy_grid(int columns, int rows);  ///< the same, displaced by a fixed pseudo-random sequence of up to 0.3
Mesh two_components();                   ///< an icosahedron and a 3 x 3 grid, 10 apart

/// Number of closed cycles of boundary half-edges among elements that are not deleted.
int boundary_loops(const OpenMesh::TriConnectivity& mesh);
/// V - E + F of the elements that are not deleted; isolated vertices do not count.
int euler_characteristic(const OpenMesh::TriConnectivity& mesh);

}  // namespace tri::test

/// Fails with the list of problems if the mesh is not valid.
#define CHECK_VALID_MESH(mesh)                                                               \
  do {                                                                                       \
    for (const std::string& problem : ::tri::test::mesh_problems(mesh)) FAIL_CHECK(problem); \
  } while (false)
