#pragma once

#include <string>

#include "libtri/sampling/virtual_measurement.hpp"
#include "meshops/context.hpp"

namespace tri {

/// Writes where the points of a virtual measurement truly lie, as CSV: a header and one line a point,
/// `index,face,u,v,x,y,z,nx,ny,nz,outlier`. The index is 0-based, the face 1-based, lengths are in mm, outlier is 0 or
/// 1; numbers are the shortest decimals that read back as the same doubles. The file appears whole or not at all.
/// @throws IoError if it cannot be written; Cancelled
void write_truth(const std::string& path, const VirtualMeasurement& measurement, Context& context);

}  // namespace tri
