#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/model/trim_region.hpp"
#include "meshops/context.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/box_tree.hpp"

namespace tri {

/// The nearest place found so far on the model.
struct FootCandidate {
  double distance = std::numeric_limits<double>::infinity();
  Vec3 foot{0, 0, 0};
  Vec3 normal{0, 0, 0};  ///< along du x dv, of any length
  Vec2 uv{0, 0};
  std::uint32_t face = 0;          ///< position in CadModel::faces
  std::uint32_t item = 0;          ///< patch or curve piece that holds it
  bool on_curve = false;           ///< on a face curve
  bool boundary = false;           ///< and that is a trimming curve, not a seam, pole or kink
  double t = 0;                    ///< parameter on that curve
  double tie = 0;                  ///< mm: distances that differ by less are equal
  const CadFace* faces = nullptr;  ///< CadModel::faces
  std::uint64_t chance = 0;        ///< a number that depends on the point alone

  /// True if a place at distance `other` is to replace this one: nearer, or as near and on a trimming curve where this
  /// is not, or as near and on a face that goes before. So the winner does not depend on which came first.
  bool yields_to(double other, bool other_boundary, std::uint32_t other_face, std::uint32_t other_item) const {
    if (other_boundary != boundary) return other_boundary ? other <= distance + tie : other < distance - tie;
    if (other_face == face) return other < distance || (other == distance && other_item < item);
    return std::abs(other - distance) <= tie ? goes_before(other_face, face) : other < distance;
  }

  /// Which of two faces as near as each other has the point: of one shell the one of lower index. Where shells touch,
  /// chance shares the points out, so that neither shell goes without.
  bool goes_before(std::uint32_t a, std::uint32_t b) const {
    if (faces[a].shell == faces[b].shell) return a < b;
    const std::uint64_t first = mix_bits(chance ^ static_cast<std::uint64_t>(faces[a].shell));
    const std::uint64_t second = mix_bits(chance ^ static_cast<std::uint64_t>(faces[b].shell));
    return first != second ? first < second : a < b;
  }
};

/// A rectangle of a trimmed face's domain with proven bounds on the surface over it.
///
/// Within the patch, (u,v) are counted as (a,b) in [-1,1] x [-1,1]. The piece of surface lies in the oriented box.
/// Where the Hessian of the squared distance at some (a,b), lessened by e0 + e1 * distance, is positive definite, the
/// squared distance is convex over the whole patch, so that the minimum Newton's method finds is the only one.
struct SurfacePatch {
  Vec3 center;
  float axis[3][3];  // orthonormal
  float half[3];
  float seed[2][3];  // (a,b) of the foot to first order: seed * (p - center)
  double u, v, half_u, half_v;
  float e0[3], e1[3];  // aa, ab, bb
  float first[2];      // bounds of |dS/da|, |dS/db|
  float second[3];     // bounds of |d2S/daa|, |d2S/dab|, |d2S/dbb|
  std::uint32_t face;
  bool inside;       // no trimming curve comes near
  bool closed_form;  // the surface gives its own feet; the patch serves as a box only

  /// A distance that no point of the patch goes below, up to rounding of about 1e-6 of |p - center|.
  float lower_bound(const Vec3& p) const {
    const float d[3] = {static_cast<float>(p[0] - center[0]), static_cast<float>(p[1] - center[1]),
                        static_cast<float>(p[2] - center[2])};
    float sum = 0;
    for (int k = 0; k < 3; ++k) {
      const float x = std::abs(axis[k][0] * d[0] + axis[k][1] * d[1] + axis[k][2] * d[2]) - half[k];
      sum += x > 0 ? x * x : 0;
    }
    return std::sqrt(sum);
  }
  Box box() const;
};

/// Cuts the trimmed domain of `face` into patches small enough for the convexity test to hold for points near the
/// surface.
/// @param position 0-based position in CadModel::faces
/// @param diagonal mm, of the model
/// @param context  once it is cancelled, patches are missing
void make_patches(const CadFace& face, const TrimRegion& region, std::uint32_t position, double diagonal,
                  const Context& context, std::vector<SurfacePatch>& patches);

/// Replaces `best` if the part of the patch inside `region` holds a nearer point.
///
/// Newton's method with the patch's convexity test; where the test fails, the patch is halved until it holds, or until
/// bounds on distance or gradient exclude the piece.
/// @param index     written to best.item
/// @param tolerance mm: pieces that could better the distance by less are left
void closest_on_patch(const SurfacePatch& patch, std::uint32_t index, const Surface& surface, const TrimRegion& region,
                      const Vec3& p, double tolerance, FootCandidate& best);

/// For a surface with closed-form feet: replaces `best` if the trimmed face's interior holds a nearer point.
void closest_in_closed_form(const Surface& surface, const TrimRegion& region, std::uint32_t face, std::uint32_t index,
                            const Vec3& p, FootCandidate& best);

}  // namespace tri
