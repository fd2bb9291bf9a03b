#pragma once

#include <string>
#include <vector>

#include "libtri/alignment/pose.hpp"

namespace tri {

/// Reads a pose from JSON ("-" is standard input): `{"matrix": [[4x4 row-major]]}`, or a report that holds such an
/// object under "pose" or under "alignment" and "pose".
/// @throws IoError if the file cannot be read, is not JSON, holds no 4x4 matrix, or the matrix is no rigid motion.
Pose read_pose(const std::string& path);

/// Writes `{"matrix": …, "meaning": "takes the points to the model"}`; every number reads back as the same double. The
/// file appears whole or not at all. @throws IoError
void write_pose(const std::string& path, const Pose& pose);

/// Points and the places they belong to, entry by entry.
struct PointPairs {
  std::vector<Vec3> points;  ///< as measured
  std::vector<Vec3> places;  ///< in the model's frame, mm
};

/// Reads `x y z X Y Z`, one pair a line: a measured point and where it belongs on the model. Numbers are separated by
/// blanks, tabs, commas or semicolons; empty lines and lines that begin with # are skipped.
/// @throws IoError with the line if a line has not six finite numbers, or the file has fewer than three pairs.
PointPairs read_pairs(const std::string& path);

}  // namespace tri
