#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/points/point_set.hpp"

namespace tri {

/// The formats of points; `text` is .xyz, .csv and the like, `mesh` the vertices of a mesh file.
enum class PointsFormat { text, ply, pcd, mesh, ptx, e57 };

/// One position of the scanner, of a file that holds several (PTX, E57).
struct ScanInfo {
  std::string name;           ///< as the file says; may be empty
  std::string sensor;         ///< vendor, model and serial number, if the file says
  std::uint64_t points = 0;   ///< that were read
  std::uint64_t skipped = 0;  ///< records without a return or a valid coordinate
  bool has_pose = false;      ///< the pose is not the identity; it was applied to the points
  std::array<Vec3, 3> rotation{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};  ///< rows; point = rotation * own +
                                                                              ///< translation
  Vec3 translation{0, 0, 0};                                                  ///< in the unit of the file
};

/// What a file of points held, beside the points.
struct PointsFileInfo {
  PointsFormat format = PointsFormat::text;  ///< by content and ending
  std::uint64_t bytes = 0;                   ///< size of the file
  /// Unit of the coordinates where the format defines one ("m" for E57), in the names of the command line; else empty.
  std::string unit;
  std::uint64_t points_skipped = 0;  ///< records that mark a place without a measurement: NaN in PCD, 0 0 0 in PTX, an
                                     ///< invalid state in E57
  std::vector<ScanInfo> scans;       ///< of PTX and E57, in the order of the file; points are in this order too
  /// Header lines, ignored columns, how normals were recognised …: one sentence each.
  std::vector<std::string> notes;
};

/// Reads points from text (XYZ, ASC, CSV, TXT …), PLY, PCD, PTX or E57; the vertices of a mesh in STL, OBJ, OFF, 3MF or
/// glTF count as points too. Coordinates are in the unit of the file.
///
/// Text: one point a line, columns separated by blanks, tabs, commas or semicolons. A comma is the decimal point if
/// columns are separated by semicolons or blanks and no full stop occurs. Lines before the first point that do not
/// begin with a number are a header, as is a single integer (the number of points); blank lines and lines that begin
/// with #, //, % or ! are skipped. Columns 1 to 3 are the point, unless a header line names as many columns as there
/// are, x, y and z among them. Columns 4 to 6 are normals if the header says so (nx ny nz) or, without names, if they
/// are unit vectors (to 0.002) on every line. The names also tell intensity and colours (red green blue, 0 to 255), and
/// every other column of numbers is kept under its name (NaN where a line lacks it). Columns without a name are
/// ignored; a note says so. Each line is read to the nearest double. Lines are parsed in parallel; the result does not
/// depend on the number of threads. Memory: 24 bytes a point, 48 with normals, and the mapped file.
///
/// PCD: ASCII, binary and binary_compressed, version 0.7; normals, intensity, rgb or rgba, and every other field of one
/// number under its name. Points whose coordinates are all NaN are skipped and counted.
///
/// PTX and E57: all scans of the file in a common frame, each with its pose applied; with more than one, the column
/// "scan" holds its 1-based number. Records without a return are skipped and counted. PTX: intensity and colours where
/// there are any. E57: bit-packed, scaled and floating fields, cartesian or spherical; intensity as it is; colours
/// scaled to 0 to 255 by the file's limits; normals; every other numeric field under its name. Checksums are verified.
///
/// @param path file name, or "-" for standard input
/// @param info if given, receives what else is known about the file; `notes` also go to the context's log
/// @throws IoError with line or byte offset: no points, a line without three numbers, a coordinate that is not finite,
///         truncated, a kind of file that is not read. @throws Cancelled within some megabytes.
PointSet read_points(const std::string& path, Context& context, PointsFileInfo* info = nullptr);

/// As `read_points`, from bytes in memory. @param name used for messages and, by its extension, for the format.
PointSet parse_points(std::string_view bytes, const std::string& name, Context& context,
                      PointsFileInfo* info = nullptr);

/// The endings under which points are written.
inline const std::vector<std::string> points_extensions{"xyz", "txt", "asc", "csv", "ply", "pcd"};

/// Writes points as the file name ends: .xyz, .txt or .asc (blanks), .csv (header and commas), .ply and .pcd (binary).
/// All columns are written: x y z, the normal, the intensity, red green blue, further columns by name. Text has a first
/// line with their names ("# x y z intensity" where blanks separate) if there are more than points and normals. Text
/// holds the shortest decimals that read back as the same doubles; PLY and PCD hold doubles.
///
/// The file appears whole or not at all. @throws InvalidInput for another extension, or as `validate(set)`. @throws
/// IoError as `AtomicFile` does.
void write_points(const std::string& path, const PointSet& set, Context& context);

}  // namespace tri
