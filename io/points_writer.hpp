#pragma once

#include "io/atomic_file.hpp"
#include "meshops/context.hpp"
#include "meshops/point_set.hpp"

namespace tri::io_detail {

/// One point a line: x y z, the normal, the intensity, red green blue, further columns by name. The first line names
/// the columns if `header`, or if there is anything beside points and normals; behind "# " where the separator is a
/// blank.
void write_points_text(AtomicFile& file, const PointSet& set, char separator, bool header, Context& context);

/// Binary PCD 0.7: coordinates, normals, intensity and further columns in double precision, colours packed as `rgb`.
void write_pcd(AtomicFile& file, const PointSet& set, Context& context);

}  // namespace tri::io_detail
