#pragma once

#include <string>
#include <string_view>

#include "io/points_file.hpp"

// The formats behind io/points_file.hpp; they throw as `read_points` does.
namespace tri::io_detail {

PointSet parse_points_text(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info);
PointSet parse_e57(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info);
PointSet parse_ptx(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info);
PointSet parse_pcd(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info);

/// True if the first ten lines are those of a scan in PTX: two counts, four lines of three numbers, four of four.
bool has_ptx_header(std::string_view bytes);

/// True if the file begins with the comment or the first keyword of a PCD header.
bool has_pcd_header(std::string_view bytes);

}  // namespace tri::io_detail
