#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "libtri/registration.hpp"
#include "meshops/context.hpp"
#include "meshops/search/nearest_points.hpp"

namespace tri {

/// Where the surface of a model ends: free edges, and sharp ones, beyond which a face does not go on.
class Rim {
 public:
  struct Place {
    Vec3 point{0, 0, 0};
    Vec3 inward{0, 0, 0};   ///< unit, in the face's tangent plane, across the edge
    Vec3 normal{0, 0, 0};   ///< unit, of the face
    std::int32_t face = 0;  ///< 0-based position in CadModel::faces
  };

  /// Places about a thousandth of the diagonal apart along the trimming curves. @throws Cancelled
  Rim(const CadModel& model, const Registration& registration, const Context& context);
  Rim(const Rim&) = delete;
  Rim& operator=(const Rim&) = delete;

  bool empty() const { return places_.empty(); }
  const std::vector<Place>& places() const { return places_; }
  /// The nearest place on the rim within `reach` mm: of this face, or, if `face` is -1, of the face whose tangent plane
  /// the point lies nearest to. Null if there is none.
  const Place* near(const Vec3& p, std::int32_t face, double reach) const;

 private:
  std::vector<Place> places_;
  std::vector<Vec3> points_;
  std::optional<NearestPoints> tree_;
};

}  // namespace tri
