#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/number_checks.hpp"
#include "cli/points_input.hpp"
#include "meshops/operators/remove_outliers.hpp"
#include "meshops/operators/thin.hpp"
#include "meshops/points/keep_points.hpp"
#include "meshops/registry.hpp"

namespace tri::cli {
namespace {

/// Runs an operator by its name, so that its report has name and time.
template <class Options>
Report run_operator(const char* name, PointSet& points, const Options& options, Context& context) {
  return Registry::standard().at(name).run(points, &options, context);
}

}  // namespace

void add_preparation_options(CLI::App& command, PointsPreparation& preparation) {
  command
      .add_option("--voxel", preparation.voxel,
                  "Thin the points first: one measured point in each cube of this side, in mm (tri ops thin)")
      ->check(above_zero());
  command.add_flag("--remove-outliers", preparation.remove_outliers,
                   "Take away points that lie alone, before anything else (tri ops remove-outliers)");
}

PreparedPoints prepare(PointSet& points, const PointsPreparation& preparation, Context& context) {
  PreparedPoints prepared;
  prepared.measured = points.size();
  const auto note = [&](const Report& report, std::size_t before) {
    if (report.maps.vertices.empty()) return;
    std::vector<std::uint32_t> kept = kept_points(report, before);
    prepared.name_as_in_file(kept);
    prepared.original = std::move(kept);
  };
  if (preparation.remove_outliers) {
    Report report = run_operator("remove-outliers", points, RemoveOutliersOptions{}, context);
    for (std::size_t i = 0; i < report.maps.vertices.size(); ++i)
      if (report.maps.vertices[i] == ElementMaps::removed) prepared.outliers.push_back(static_cast<std::uint32_t>(i));
    note(report, prepared.measured);
    prepared.reports.push_back(std::move(report));
  }
  if (preparation.voxel > 0) {
    const std::size_t before = points.size();
    Report report = run_operator("thin", points, ThinOptions{.voxel = preparation.voxel}, context);
    note(report, before);
    prepared.reports.push_back(std::move(report));
  }
  return prepared;
}

void PreparedPoints::name_as_in_file(std::vector<std::uint32_t>& indices) const {
  if (original.empty()) return;
  for (std::uint32_t& i : indices) i = original[i];
}

nlohmann::ordered_json to_json(const PointsPreparation& preparation) {
  nlohmann::ordered_json json{{"voxel", nullptr}, {"remove_outliers", preparation.remove_outliers}};
  if (preparation.voxel > 0) json["voxel"] = preparation.voxel;
  return json;
}

void add_to_report(nlohmann::ordered_json& report, const PreparedPoints& prepared) {
  if (prepared.reports.empty()) return;
  report["points"] = prepared.measured;
  report["points_used"] = prepared.original.empty() ? prepared.measured : prepared.original.size();
  report["removed_outliers"] = prepared.outliers;
  report["preparation"] = nlohmann::ordered_json::array();
  for (const Report& step : prepared.reports) report["preparation"].push_back(tri::to_json(step));
}

std::string summary(const PreparedPoints& prepared) {
  std::string text;
  std::uint64_t left = prepared.measured;
  for (const Report& report : prepared.reports) {
    text += fmt::format("{}: {} of {} points removed\n", report.operation, with_commas(report.vertices_removed),
                        with_commas(left));
    left -= report.vertices_removed;
  }
  return text;
}

}  // namespace tri::cli
