#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "cli/info.hpp"
#include "cli/points_input.hpp"
#include "meshops/checks/point_summary.hpp"

namespace tri::cli {
namespace {

const char* name_of(PointsFormat format) {
  switch (format) {
    case PointsFormat::text:
      return "text";
    case PointsFormat::ply:
      return "PLY";
    case PointsFormat::pcd:
      return "PCD";
    case PointsFormat::ptx:
      return "PTX";
    case PointsFormat::e57:
      return "E57";
    case PointsFormat::mesh:
      return "vertices of a mesh file";
  }
  return "";
}

std::string unit_text(const PointUnits& units, const PointsFileInfo& file) {
  if (units.given != "auto") return fmt::format("{}, as asked for; shown in mm", units.given);
  if (!file.unit.empty()) return fmt::format("{}, as the format defines; shown in mm", file.unit);
  return "not said by the file; taken as mm";
}

/// The least and the largest of the values that are known.
struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  std::uint64_t unknown = 0;

  explicit Range(const std::vector<double>& values) {
    for (const double v : values) {
      unknown += std::isnan(v);
      if (v < low) low = v;
      if (v > high) high = v;
    }
  }
  std::string text() const {
    if (low > high) return "not one value is known";
    return fmt::format("{:.6g} to {:.6g}{}", low, high,
                       unknown > 0 ? fmt::format(", {} unknown", with_commas(unknown)) : "");
  }
  nlohmann::ordered_json json() const {
    nlohmann::ordered_json result{{"low", nullptr}, {"high", nullptr}, {"unknown", unknown}};
    if (low <= high) result["low"] = low, result["high"] = high;
    return result;
  }
};

void add_columns(Info& info, const PointSet& set) {
  info.line("normals", set.normals.empty() ? "no" : "yes");
  info.line("intensity", set.intensity.empty() ? "no" : Range(set.intensity).text());
  info.line("colours", set.colors.empty() ? "no" : "yes");
  info.json["normals"] = !set.normals.empty();
  info.json["intensity"] = nullptr;
  if (!set.intensity.empty()) info.json["intensity"] = Range(set.intensity).json();
  info.json["colors"] = !set.colors.empty();
  info.json["columns"] = nlohmann::ordered_json::object();
  for (const auto& [name, values] : set.scalars) {
    const Range range(values);
    info.line("column " + name, range.text());
    info.json["columns"][name] = range.json();
  }
}

/// @param factor  millimetres per unit of the file
void add_scans(Info& info, const PointsFileInfo& file, double factor) {
  info.json["scans"] = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < file.scans.size(); ++k) {
    const ScanInfo& scan = file.scans[k];
    std::string text = fmt::format("{} points", with_commas(scan.points));
    if (scan.skipped > 0) text += fmt::format(", {} not measured", with_commas(scan.skipped));
    if (!scan.name.empty()) text += fmt::format(", \"{}\"", scan.name);
    if (!scan.sensor.empty()) text += ", " + scan.sensor;
    const Vec3 place = scan.translation * factor;
    if (scan.has_pose) {
      const double trace = scan.rotation[0][0] + scan.rotation[1][1] + scan.rotation[2][2];
      const double turn = std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi;
      text += fmt::format(", scanner at ({:.6g}, {:.6g}, {:.6g}), turned by {:.4g} degrees", place[0], place[1],
                          place[2], turn);
    }
    info.line(fmt::format("scan {}", k + 1), text);
    nlohmann::ordered_json rotation = nlohmann::ordered_json::array();
    for (const Vec3& row : scan.rotation) rotation.push_back({row[0], row[1], row[2]});
    info.json["scans"].push_back({{"name", scan.name},
                                  {"sensor", scan.sensor},
                                  {"points", scan.points},
                                  {"skipped", scan.skipped},
                                  {"rotation", rotation},
                                  {"translation", {place[0], place[1], place[2]}}});
  }
}

}  // namespace

Info points_info(const std::string& path, const PointUnits& units, Program& program) {
  PointsFileInfo file;
  const PointSet set = read_points_in_mm(path, units, program, &file);
  const PointSummary s = summarize(set.points);
  Info info;
  info.json = {{"kind", "points"}, {"format", name_of(file.format)}, {"bytes", file.bytes}};
  info.json.update(to_json(units, file));
  info.line("points", fmt::format("{}, {} bytes", name_of(file.format), with_commas(file.bytes)));
  info.line("number", with_commas(s.points));
  if (file.points_skipped > 0)
    info.line("not measured", fmt::format("{} records without a return or a valid place were skipped",
                                          with_commas(file.points_skipped)));
  if (s.duplicates > 0) info.line("duplicates", with_commas(s.duplicates));
  add_columns(info, set);
  add_scans(info, file, factor_of(units, file));
  info.line("unit", unit_text(units, file));
  add_box(info, s.box_min, s.box_max);
  info.line("spacing", fmt::format("{:.4g} to the nearest neighbour (median); 90% are {:.4g} to {:.4g}",
                                   s.spacing_median, s.spacing_5, s.spacing_95));
  info.notes = file.notes;
  info.json["points"] = s.points;
  info.json["points_skipped"] = file.points_skipped;
  info.json["duplicates"] = s.duplicates;
  info.json["spacing"] = {{"median", s.spacing_median}, {"p5", s.spacing_5}, {"p95", s.spacing_95}};
  info.json["notes"] = file.notes;
  return info;
}

}  // namespace tri::cli
