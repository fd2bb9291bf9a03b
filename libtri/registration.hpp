#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libtri/cad_model.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Where one point lands on the trimmed model.
struct Foot {
  Vec3 point{0, 0, 0};            ///< closest point on the model, S(u,v) of its face
  Vec2 uv{0, 0};                  ///< on the face's own surface, inside or on its trimming loops
  double deviation = 0;           ///< mm, signed distance, positive on the outside
  std::array<float, 3> normal{};  ///< unit outward normal at the foot
  std::int32_t face = -1;         ///< 0-based position in CadModel::faces; -1 if the point is not finite
  std::int32_t edge = -1;         ///< 0-based position in CadModel::edges if the foot lies on a trimming curve; else -1
};

/// Finds for every point the closest point on the trimmed faces of a model [Ristic et al. 2000, step (b)].
///
/// Built once per model; `register_points` may be called from several threads.
class Registration {
 public:
  explicit Registration(const CadModel& model);
  ~Registration();
  Registration(Registration&&) noexcept;

  /// The global closest point for each of `points`. Ties across a shared edge go to the face with the lower index.
  /// @throws Cancelled at the granularity of 4096 points.
  std::vector<Foot> register_points(std::span<const Vec3> points, Context& context) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tri
