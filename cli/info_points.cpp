#include <fmt/format.h>

#include "cli/info.hpp"
#include "cli/points_input.hpp"
#include "meshops/point_summary.hpp"

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
    info.line("not measured", fmt::format("{} (NaN, skipped)", with_commas(file.points_skipped)));
  if (s.duplicates > 0) info.line("duplicates", with_commas(s.duplicates));
  info.line("normals", set.normals.empty() ? "no" : "yes");
  info.line("unit", unit_text(units, file));
  add_box(info, s.box_min, s.box_max);
  info.line("spacing", fmt::format("{:.4g} to the nearest neighbour (median); 90% are {:.4g} to {:.4g}",
                                   s.spacing_median, s.spacing_5, s.spacing_95));
  info.notes = file.notes;
  info.json["points"] = s.points;
  info.json["points_skipped"] = file.points_skipped;
  info.json["duplicates"] = s.duplicates;
  info.json["normals"] = !set.normals.empty();
  info.json["spacing"] = {{"median", s.spacing_median}, {"p5", s.spacing_5}, {"p95", s.spacing_95}};
  info.json["notes"] = file.notes;
  return info;
}

}  // namespace tri::cli
