#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "io/mesh_file.hpp"
#include "io/points_file.hpp"
#include "meshops/error.hpp"

// What holds for every input: it is refused with an IoError, or what was read is consistent. Anything else stops the
// program.
namespace tri::fuzz {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", what);
  std::abort();
}

inline bool finite(const Vec3& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/// @return true if the bytes were accepted
inline bool read_as_mesh(std::string_view bytes, const std::string& name) {
  Context context;
  MeshFileInfo info;
  Soup soup;
  try {
    soup = parse_mesh(bytes, name, context, &info);
  } catch (const IoError&) {
    return false;
  }
  const std::size_t n = soup.points.size();
  for (const Vec3& p : soup.points) require(finite(p), "a coordinate is not finite");
  for (const Triangle& t : soup.triangles)
    for (const auto v : t) require(v < n, "an index is out of range");
  require(soup.vertex_colors.empty() || soup.vertex_colors.size() == n, "a colour for each vertex");
  require(soup.vertex_normals.empty() || soup.vertex_normals.size() == n, "a normal for each vertex");
  for (const auto& scalar : soup.vertex_scalars) require(scalar.second.size() == n, "a scalar for each vertex");
  for (const auto& scalar : soup.face_scalars)
    require(scalar.second.size() == soup.triangles.size(), "a scalar for each face");
  for (const auto& scalar : soup.corner_scalars)
    require(scalar.second.size() == 3 * soup.triangles.size(), "a scalar for each corner");
  require(info.polygons <= soup.triangles.size(), "a triangle for each polygon");
  return true;
}

/// @return true if the bytes were accepted
inline bool read_as_points(std::string_view bytes, const std::string& name) {
  Context context;
  context.threads = 1;
  PointsFileInfo info;
  PointSet set;
  try {
    set = parse_points(bytes, name, context, &info);
  } catch (const IoError&) {
    return false;
  }
  require(!set.points.empty(), "at least one point");
  try {
    validate(set);
  } catch (const InvalidInput&) {
    require(false, "columns of one length, coordinates finite");
  }
  std::uint64_t points = 0, skipped = 0;
  for (const ScanInfo& scan : info.scans) points += scan.points, skipped += scan.skipped;
  require(info.scans.empty() || (points == set.size() && skipped == info.points_skipped), "every point is of a scan");
  return true;
}

}  // namespace tri::fuzz
