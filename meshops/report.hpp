#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tri {

/// Old to new indices after elements were renumbered; empty if none were. `removed` marks elements that are gone.
struct ElementMaps {
  static constexpr std::uint32_t removed = 0xffffffff;  ///< in place of an index: the element is gone

  /// The new index of each old vertex.
  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> edges;  ///< half-edge h becomes 2 * edges[h / 2] + h % 2
  std::vector<std::uint32_t> faces;  ///< of each old face

  /// True if nothing was renumbered.
  bool empty() const { return vertices.empty() && edges.empty() && faces.empty(); }
};

/// What one operator changed. All counts zero means that the mesh was returned bit for bit.
struct Report {
  std::string operation;  ///< registered name, say "fill-holes"

  std::uint64_t vertices_added = 0;    ///< new ones, copies included
  std::uint64_t vertices_removed = 0;  ///< marked as deleted, or joined with others
  std::uint64_t vertices_moved = 0;    ///< of those that stayed: with another position
  std::uint64_t faces_added = 0;       ///< new ones
  std::uint64_t faces_removed = 0;     ///< marked as deleted, or taken out of a soup
  std::uint64_t faces_reversed = 0;    ///< with the same corners, facing the other way
  std::uint64_t edges_flipped = 0;     ///< turned into the other diagonal of their two triangles

  /// What was found but left as it is, by reason ("loop too long": 3).
  std::map<std::string, std::uint64_t> skipped;
  /// Further named figures of the operator ("holes filled": 2).
  std::map<std::string, double> figures;
  /// Sentences for a person, each naming a place or a number.
  std::vector<std::string> notes;

  /// Indices of touched elements in the mesh as the operator left it (before any compaction).
  std::vector<std::uint32_t> touched_vertices;
  std::vector<std::uint32_t> touched_faces;  ///< the same of faces, or of triangles of a soup

  /// Filled by operators that renumber (`compact`).
  ElementMaps maps;

  double seconds = 0;  ///< wall-clock time; 0 unless it was run through the registry or a pipeline

  /// True if nothing was added, removed, moved, reversed or flipped.
  bool unchanged() const {
    return vertices_added == 0 && vertices_removed == 0 && vertices_moved == 0 && faces_added == 0 &&
           faces_removed == 0 && faces_reversed == 0 && edges_flipped == 0;
  }
};

/// Operation, seconds, the counts that are not zero, `skipped`, `figures`, `notes`, and the numbers of touched
/// elements.
nlohmann::ordered_json to_json(const Report& report);

}  // namespace tri
