#pragma once

#include <cstdint>
#include <vector>

#include "libtri/model/cad_model.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Points on the trimmed faces of a model.
struct SurfaceSamples {
  std::vector<Vec3> points;         ///< mm
  std::vector<Vec3> normals;        ///< unit, outward as CadFace::reversed says
  std::vector<std::int32_t> faces;  ///< 0-based positions in CadModel::faces
};

/// Places drawn uniformly over the area of the trimmed faces, face by face; each face gets its share to within one.
///
/// A face whose area is unknown (0) gets none; a face that hardly fills its parameter box may get fewer than its share.
/// The same for any number of threads. @param count > 0
SurfaceSamples sample_surface(const CadModel& model, std::size_t count, std::uint64_t seed, const Context& context);

}  // namespace tri
