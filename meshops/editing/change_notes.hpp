#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tri {

/// What became of the elements of one kind; indices ascend, each at most once in a list.
struct ElementNotes {
  std::vector<std::uint32_t> added;    ///< there now and not before
  std::vector<std::uint32_t> removed;  ///< marked as deleted now and not before
  /// Of those that stayed: edges with other ends, faces with other corners or another order of them (some may have the
  /// same); vertices with another outgoing half-edge.
  std::vector<std::uint32_t> relinked;
  /// Of those that stayed: with properties or status written to (some may have the same values). Values of half-edges
  /// count as their face's, or as their edge's where they have no face.
  std::vector<std::uint32_t> revalued;

  /// True if no list has an entry.
  bool empty() const { return added.empty() && removed.empty() && relinked.empty() && revalued.empty(); }
};

/// What changed, so that an editor uploads only that.
struct ChangeNotes {
  ElementNotes vertices;                      ///< what became of them, but for their places
  ElementNotes edges;                         ///< half-edges 2 i and 2 i + 1 count as edge i
  ElementNotes faces;                         ///< what became of them
  std::vector<std::uint32_t> vertices_moved;  ///< of those that stayed
  /// Everything may have changed, elements have other indices and the lists are empty (`compact`).
  bool renumbered = false;
  std::vector<std::string> properties_added;      ///< names of those there now and not before
  std::vector<std::string> properties_removed;    ///< names of those there before and not now
  std::vector<std::string> properties_rewritten;  ///< as a whole

  /// True if nothing changed.
  bool empty() const;
  /// What an undo changes: what was added is removed and the other way round.
  ChangeNotes inverse() const;
};

}  // namespace tri
