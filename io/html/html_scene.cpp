#include "io/html/html_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/html/html_text.hpp"
#include "io/pictures/picture.hpp"
#include "io/pictures/render.hpp"
#include "meshops/error.hpp"
#include "meshops/points/thin_for_display.hpp"

namespace tri {
namespace {

constexpr float missing = 3e38f;  // a deviation that is not known; the script tests for more than 1e30
constexpr std::size_t most_picture_dots = 30'000;
const Vec3 from_part_to_eye(-0.55, -1.0, 0.7);  // as RenderOptions has it
const Vec3 backdrop_color(0.83, 0.85, 0.87);

struct Frame {
  Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3 high = -low;

  void grow(const Soup& soup) {
    for (const Vec3& p : soup.points) {
      if (!std::isfinite(p.norm())) throw InvalidInput("a point to be shown has a coordinate that is not finite");
      low.minimize(p);
      high.maximize(p);
    }
  }
  double diagonal() const { return (high - low).norm(); }
};

Color byte_color(const Vec3& color) {
  Color bytes;
  for (int k = 0; k < 3; ++k)
    bytes[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(color[k], 0.0, 1.0)));
  return bytes;
}

// Places as 16-bit shares of the frame: for the eye, to 1/65535 of the part.
std::string packed_points(const Soup& soup, const Frame& frame) {
  std::vector<std::uint16_t> packed;
  packed.reserve(3 * soup.points.size());
  for (const Vec3& p : soup.points)
    for (int k = 0; k < 3; ++k) {
      const double length = frame.high[k] - frame.low[k];
      packed.push_back(
          static_cast<std::uint16_t>(length > 0 ? std::lround((p[k] - frame.low[k]) / length * 65535) : 0));
    }
  return base64_of(std::span<const std::uint16_t>(packed));
}

std::string packed_triangles(const Soup& soup) {
  static_assert(sizeof(Triangle) == 12);
  return base64_of(std::span<const Triangle>(soup.triangles));
}

nlohmann::ordered_json packed(const Soup& soup, const Frame& frame) {
  nlohmann::ordered_json json{{"vertices", soup.points.size()},
                              {"triangles", soup.triangles.size()},
                              {"positions", packed_points(soup, frame)}};
  if (!soup.triangles.empty()) json["indices"] = packed_triangles(soup);
  if (const auto found = soup.vertex_scalars.find("deviation"); found != soup.vertex_scalars.end()) {
    std::vector<float> values;
    values.reserve(found->second.size());
    for (const double v : found->second) values.push_back(std::isfinite(v) ? static_cast<float>(v) : missing);
    json["deviation"] = base64_of(std::span<const float>(values));
  }
  if (const auto found = soup.vertex_scalars.find("cad_face"); found != soup.vertex_scalars.end()) {
    std::vector<std::int32_t> values;
    values.reserve(found->second.size());
    for (const double v : found->second) values.push_back(v >= 0 && v < 1e9 ? static_cast<std::int32_t>(v) : 0);
    json["face"] = base64_of(std::span<const std::int32_t>(values));
  }
  return json;
}

// 256 colours from one end of the scale to the other, then those below, above and of what has no value.
std::string palette_of(const DeviationScale& scale) {
  std::string bytes;
  const auto add = [&](const Vec3& color) {
    for (const std::uint8_t byte : byte_color(color)) bytes += static_cast<char>(byte);
  };
  for (int i = 0; i < 256; ++i) add(deviation_color(scale.low + (scale.high - scale.low) * i / 255, scale));
  add(deviation_color(std::nextafter(scale.low, -std::numeric_limits<double>::infinity()), scale));
  add(deviation_color(std::nextafter(scale.high, std::numeric_limits<double>::infinity()), scale));
  add(missing_color());
  return base64(bytes);
}

std::vector<Color> colors_of(const Soup& soup, const DeviationScale& scale) {
  std::vector<Color> colors(soup.points.size(), byte_color(missing_color()));
  if (const auto found = soup.vertex_scalars.find("deviation"); found != soup.vertex_scalars.end())
    for (std::size_t i = 0; i < colors.size(); ++i) colors[i] = byte_color(deviation_color(found->second[i], scale));
  return colors;
}

// Points over a surface as squares that face the eye, a little nearer to it so that the surface does not swallow them.
Soup dots_over(const Soup& backdrop, const Soup& points, const DeviationScale& scale, double diagonal) {
  Soup result;
  result.points = backdrop.points;
  result.triangles = backdrop.triangles;
  result.vertex_colors.assign(backdrop.points.size(), byte_color(backdrop_color));
  const Soup dots = thin_for_display(points, std::min(most_picture_dots, points.points.size()));
  const std::vector<Color> colors = colors_of(dots, scale);
  const Vec3 eye = from_part_to_eye.normalized();
  const Vec3 right = (Vec3(0, 0, 1) % eye).normalized() * (0.0022 * diagonal),
             up = (eye % right).normalized() * right.norm();
  for (std::size_t i = 0; i < dots.points.size(); ++i) {
    const Vec3 at = dots.points[i] + eye * (0.004 * diagonal);
    const auto first = static_cast<std::uint32_t>(result.points.size());
    result.points.insert(result.points.end(), {at - right - up, at + right - up, at + right + up, at - right + up});
    result.vertex_colors.insert(result.vertex_colors.end(), 4, colors[i]);
    result.triangles.push_back({first, first + 1, first + 2});
    result.triangles.push_back({first, first + 2, first + 3});
  }
  return result;
}

std::string picture_of(const Soup& scene, const Soup* backdrop, const DeviationScale& scale, double diagonal,
                       Context& context) {
  Soup colored;
  if (scene.triangles.empty() && backdrop) {
    colored = dots_over(*backdrop, scene, scale, diagonal);
  } else {
    colored = scene;
    colored.vertex_colors = colors_of(scene, scale);
  }
  RenderOptions options;
  options.width = 1120;
  options.height = 760;
  options.smooth = true;
  return base64(encode_png(render(colored, options, context).picture));
}

std::string counted(const Soup& soup) {
  return soup.triangles.empty() ? fmt::format("{} points", soup.points.size())
                                : fmt::format("{} triangles", soup.triangles.size());
}

}  // namespace

HtmlScene html_scene(const HtmlReport& report, Context& context) {
  if (!report.scene || report.scene->points.empty()) throw InvalidInput("there is nothing to show in a report");
  if (report.most_elements == 0) throw InvalidInput("most_elements is 0; it must be above 0");
  const Soup* backdrop = report.backdrop && !report.backdrop->triangles.empty() ? report.backdrop : nullptr;
  HtmlScene result;
  const Soup scene = thin_for_display(*report.scene, report.most_elements);
  if (counted(scene) != counted(*report.scene))
    result.notes.push_back(fmt::format("The picture shows {} of {}; all numbers are of the whole.", counted(scene),
                                       counted(*report.scene)));
  Soup thin_backdrop;
  if (backdrop) thin_backdrop = thin_for_display(*backdrop, report.most_elements);
  Frame frame;
  frame.grow(scene);
  if (backdrop) frame.grow(thin_backdrop);
  context.checkpoint();
  result.picture = picture_of(scene, backdrop ? &thin_backdrop : nullptr, report.scale, frame.diagonal(), context);
  result.json = {{"low", {frame.low[0], frame.low[1], frame.low[2]}},
                 {"high", {frame.high[0], frame.high[1], frame.high[2]}},
                 {"view", {from_part_to_eye[0], from_part_to_eye[1], from_part_to_eye[2]}},
                 {"scaleLow", report.scale.low},
                 {"scaleHigh", report.scale.high},
                 {"tolerance", report.scale.tolerance},
                 {"unit", report.unit},
                 {"decimals", decimals_for(std::max(std::abs(report.scale.low), std::abs(report.scale.high)))},
                 {"palette", palette_of(report.scale)},
                 {"scene", packed(scene, frame)},
                 {"backdrop", nullptr},
                 {"spots", nlohmann::ordered_json::array()}};
  if (backdrop) result.json["backdrop"] = packed(thin_backdrop, frame);
  for (const HtmlSpot& spot : report.spots)
    result.json["spots"].push_back({{"at", {spot.position[0], spot.position[1], spot.position[2]}},
                                    {"normal", {spot.normal[0], spot.normal[1], spot.normal[2]}},
                                    {"text", spot.text}});
  return result;
}

}  // namespace tri
