#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/search/overlap_tree.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// How many triangles of a mesh another triangle crosses, while the mesh changes a few triangles at a time. Triangles
/// that share a vertex do not count.
class CrossingSearch {
 public:
  /// @param positions  of the vertices; referred to, as is `triangles`
  /// @param ids  the triangles that count, each once
  /// @param context  referred to; null: cannot be cancelled @throws Cancelled
  CrossingSearch(std::span<const Vec3> positions, const std::vector<Triangle>& triangles,
                 std::vector<std::uint32_t> ids, const Context* context = nullptr);

  /// To be called after `triangles[t]` was changed. Many changes slow the search down until `refresh`.
  void note_change(std::uint32_t t);
  std::size_t changes() const { return changed_list_.size(); }
  /// Sorts all triangles anew. @throws Cancelled; nothing may be asked then
  void refresh();

  /// @param skip  triangles that do not count
  long count(const Triangle& q, std::span<const std::int32_t> skip) const;

 private:
  OverlapTree::Box box_of(const Triangle& t) const;

  std::span<const Vec3> positions_;
  const std::vector<Triangle>& triangles_;
  std::vector<std::uint32_t> ids_;
  const Context* context_;
  std::optional<OverlapTree> tree_;  // of positions in ids_
  std::vector<bool> changed_;
  std::vector<std::uint32_t> changed_list_;
};

}  // namespace tri
