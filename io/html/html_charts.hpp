#pragma once

#include <optional>
#include <string>

#include "io/pictures/palette.hpp"
#include "meshops/checks/value_statistics.hpp"

namespace tri {

/// "#rrggbb" of a colour of io/pictures/palette.hpp.
std::string css_color(const Vec3& color);

/// The colours of deviations as an upright bar with numbers, as SVG; with a tolerance also the two colours beyond its
/// ends.
/// @param unit  text behind the numbers, "mm"
std::string legend_svg(const DeviationScale& scale, const std::string& unit);

/// How often deviations occur, as SVG: bars in the colours of `scale`, its ends and 0 marked.
/// @param mean  marked, too, where given
std::string histogram_svg(const Histogram& histogram, const DeviationScale& scale, std::optional<double> mean,
                          const std::string& unit);

}  // namespace tri
