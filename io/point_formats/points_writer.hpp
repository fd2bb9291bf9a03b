#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/atomic_file.hpp"
#include "meshops/context.hpp"
#include "meshops/points/point_set.hpp"

namespace tri::io_detail {

using NamedColumns = std::vector<std::pair<std::string, const std::vector<double>*>>;

/// The further columns of a set, by names without the characters that separate names in text files and headers.
/// @param taken  a column of one of these names becomes "input_NAME"
NamedColumns numbers_of(const PointSet& set, std::span<const std::string_view> taken = {});

/// One point a line: x y z, the normal, the intensity, red green blue, further columns by name. The first line names
/// the columns if `header`, or if there is anything beside points and normals; behind "# " where the separator is a
/// blank.
void write_points_text(AtomicFile& file, const PointSet& set, char separator, bool header, Context& context);

/// Binary PCD 0.7: coordinates, normals, intensity and further columns in double precision, colours packed as `rgb`.
void write_pcd(AtomicFile& file, const PointSet& set, Context& context);

}  // namespace tri::io_detail
