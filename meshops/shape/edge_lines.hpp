#pragma once

#include <cstdint>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/search/box_tree.hpp"
#include "meshops/shape/features.hpp"

namespace tri {

/// The boundaries, creases and seams of attributes of a mesh as it was: polylines between corners, on which vertices
/// may slide. Immutable; may be shared between threads.
class EdgeLines {
 public:
  static constexpr std::int32_t none = -1;

  /// What may become of a vertex.
  enum class Kind : std::uint8_t {
    free,   ///< on no line
    along,  ///< on one, which does not turn much here
    fixed,  ///< a corner, the end of a line, where lines meet; and what is not selected
  };

  /// Looks for the lines. @throws Cancelled
  EdgeLines(MeshView mesh, const FeatureRules& rules, const Context& context);

  /// One entry per edge or vertex of the mesh as it was.
  const std::vector<std::int32_t>& lines() const { return lines_; }  ///< the line on which an edge lies, or `none`
  const std::vector<Kind>& kinds() const { return kinds_; }

  /// The point of a line that is nearest. @param line  that has an edge
  Vec3 closest(const Vec3& p, std::int32_t line) const;

  /// How far a chord is from a line: the greatest distance of three places, a quarter of the chord apart.
  double chord_error(const Vec3& from, const Vec3& to, std::int32_t line) const;

 private:
  struct Segment {
    Vec3 a, b;
    std::int32_t line;
  };
  std::vector<std::int32_t> lines_;
  std::vector<Kind> kinds_;
  std::vector<Segment> segments_;
  BoxTree tree_;
};

}  // namespace tri
