#include "io/mesh_formats/float_rounding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "meshops/error.hpp"
#include "meshops/single_precision.hpp"

namespace tri::io_detail {
void note_rounding_to_floats(const Soup& soup, const char* format, MeshWriteReport& report) {
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    const Vec3& p = soup.points[i];
    double rounding = 0;
    for (int k = 0; k < 3; ++k) {
      if (std::abs(p[k]) > static_cast<double>(FLT_MAX))
        throw InvalidInput(fmt::format("vertex {}: {} is beyond the floats of {}", i, p[k], format));
      rounding = std::max(rounding, std::abs(p[k] - rounded_to_float(p[k])));
    }
    report.max_rounding = std::max(report.max_rounding, rounding);
    report.rounded_vertices += rounding > 0;
  }
  if (report.rounded_vertices == 0) return;
  report.notes.push_back(
      fmt::format("coordinates were rounded to the floats of {}: {} of {} vertices, by at most {:.3g}", format,
                  report.rounded_vertices, soup.points.size(), report.max_rounding));
  std::uint64_t collapsed = 0;
  for (const Triangle& t : soup.triangles) {
    bool collapses = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = soup.points[t[k]], &b = soup.points[t[(k + 1) % 3]];
      collapses = collapses || (a != b && rounded_to_floats(a) == rounded_to_floats(b));
    }
    collapsed += collapses;
  }
  if (collapsed > 0) report.notes.push_back(fmt::format("by that rounding {} triangles lost their area", collapsed));
}

}  // namespace tri::io_detail
