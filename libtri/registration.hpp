#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Where one point lands on the trimmed model.
struct Foot {
  Vec3 point{0, 0, 0};            ///< closest point on the model, S(u,v) of its face
  Vec2 uv{0, 0};                  ///< on the face's own surface, inside or on its trimming loops
  double deviation = 0;           ///< mm, signed distance, positive on the outside
  std::array<float, 3> normal{};  ///< unit outward normal of that face at the foot; its limit at a pole
  std::int32_t face = -1;         ///< 0-based position in CadModel::faces; -1 if the point is not finite
  /// 0-based position in CadModel::edges if the foot lies on a trimming curve; else -1. Seams of closed faces and poles
  /// have material all around and are no trimming curves.
  std::int32_t edge = -1;
};

/// Finds for every point the closest point on the trimmed faces of a model [Ristic et al. 2000, step (b)].
///
/// The faces are cut into patches, the trimming curves into pieces, each in a box that provably holds it. A search from
/// the nearest box outward runs Newton's method where the squared distance is provably convex over the patch, and
/// halves the patch where it is not, so that the least distance of all is found and not a local one: to 1e-8 of the
/// model's diagonal, in practice to rounding. Planes, cylinders, cones, spheres and tori have closed forms. A foot
/// outside the trimming curves is never taken: the test follows the curves themselves, not polygons. Only where an
/// offset surface's base degenerates do samples with a margin stand in for proven bounds.
///
/// At an edge the deviation's sign is that of the sum of the adjacent faces' normals, at a vertex of their sum
/// weighted by angle [Baerentzen & Aanaes 2005].
///
/// Built once per model; nothing of the model is referred to afterwards. `register_points` may be called from several
/// threads.
class Registration {
 public:
  /// 0.05 to 0.4 s for a hundred thousand patches, on all threads that the context allows.
  /// @throws Cancelled within milliseconds.
  Registration(const CadModel& model, Context& context);
  /// The same on every core, without progress and cancel.
  explicit Registration(const CadModel& model);
  ~Registration();
  /// The other one can only be destroyed afterwards.
  Registration(Registration&&) noexcept;

  /// The global closest point for each of `points` (mm, any order, any number), in their order.
  ///
  /// Where several faces of one shell are equally near, to 1e-10 of the diagonal, the one with the lowest index wins:
  /// along a shared edge, at a vertex, and half-way between two faces. Where two shells touch, a number made of the
  /// point's coordinates decides, so that both get their share of the points. A foot that is as near on a trimming
  /// curve is taken to be on it. So face and edge do not depend on the order of the points; neither does the rest, but
  /// for the 1e-8 of the diagonal to which places far from the model are searched. Nothing depends on the number of
  /// threads. Beside the result it takes 20 bytes a point.
  /// @throws Cancelled within 64 points of each thread: well within 100 ms.
  std::vector<Foot> register_points(std::span<const Vec3> points, Context& context) const;

  /// The order in which `register_points` visits the points: along a space-filling curve through the model's box.
  /// Points that are already in it are registered faster.
  std::vector<std::uint32_t> order_of(std::span<const Vec3> points) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tri
