#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace tri {

/// Old to new indices after elements were renumbered; empty if none were. `removed` marks elements that are gone.
struct ElementMaps {
  static constexpr std::uint32_t removed = 0xffffffff;

  std::vector<std::uint32_t> vertices;
  std::vector<std::uint32_t> edges;  ///< half-edge h becomes 2 * edges[h / 2] + h % 2
  std::vector<std::uint32_t> faces;

  bool empty() const { return vertices.empty() && edges.empty() && faces.empty(); }
};

/// What one operator changed. All counts zero means that the mesh was returned bit for bit.
struct Report {
  std::string operation;  ///< registered name, say "fill-holes"

  std::uint64_t vertices_added = 0;
  std::uint64_t vertices_removed = 0;
  std::uint64_t vertices_moved = 0;
  std::uint64_t faces_added = 0;
  std::uint64_t faces_removed = 0;
  std::uint64_t faces_reversed = 0;
  std::uint64_t edges_flipped = 0;

  /// What was found but left as it is, by reason ("loop too long": 3).
  std::map<std::string, std::uint64_t> skipped;
  /// Further named figures of the operator ("holes filled": 2).
  std::map<std::string, double> figures;
  /// Sentences for a person, each naming a place or a number.
  std::vector<std::string> notes;

  /// Indices of touched elements in the mesh as the operator left it (before any compaction).
  std::vector<std::uint32_t> touched_vertices;
  std::vector<std::uint32_t> touched_faces;

  /// Filled by operators that renumber (`compact`).
  ElementMaps maps;

  double seconds = 0;

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
