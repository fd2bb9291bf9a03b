#pragma once

#include <future>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "io/points_file.hpp"
#include "meshops/points/point_set.hpp"
#include "meshops/report.hpp"

namespace tri::cli {

/// The `--units` of every command that reads points: shared, so that they mean the same everywhere.
struct PointUnits {
  std::string given = "auto";  ///< a name ("inch"), millimetres per unit ("25.4"), or "auto"
};

/// Adds --units to a command.
void add_units_option(CLI::App& command, PointUnits& units);

/// What one unit is, in millimetres: mm, cm, dm, m, km, um, nm, in, inch, ft, foot, yd, mil, thou or a number above 0.
/// "auto" is 0: the file decides. @throws UsageError naming what is allowed.
double millimetres_per(const std::string& unit);

/// Points of a file, in millimetres. With "auto" a format that defines its unit (E57: metres) is converted, and a note
/// on standard error says so; any other file is taken to be in millimetres.
/// @param info receives what is known about the file @throws as `read_points`
PointSet read_points_in_mm(const std::string& path, const PointUnits& units, Program& program,
                           PointsFileInfo* info = nullptr);

/// As `read_points_in_mm`, while the caller does something else, say read the model.
class PointsInBackground {
 public:
  /// Begins, if `path` is a file; of anything else, which may keep a reader waiting, nothing is read before `get`.
  PointsInBackground(std::string path, PointUnits units, Program& program);
  PointsInBackground(const PointsInBackground&) = delete;
  PointsInBackground& operator=(const PointsInBackground&) = delete;
  ~PointsInBackground();  ///< stops reading

  /// Once: waits, says what is to be said of the file, and returns its points.
  /// @param info receives what is known about the file @throws as `read_points`
  PointSet get(PointsFileInfo* info = nullptr);

 private:
  std::string path_;
  PointUnits units_;
  Program& program_;
  Context quiet_;
  std::vector<std::string> log_;
  PointsFileInfo info_;
  std::future<PointSet> points_;  // its destructor waits, so it goes first
};

/// For reports: {"units": as given, "mm_per_unit": the factor that was applied}.
nlohmann::ordered_json to_json(const PointUnits& units, const PointsFileInfo& info);

/// The factor for this file.
double factor_of(const PointUnits& units, const PointsFileInfo& info);

/// The `--voxel` and `--remove-outliers` of the commands that measure or connect points; both off by default.
struct PointsPreparation {
  double voxel = 0;              ///< mm; 0: every point is kept
  bool remove_outliers = false;  ///< with the operator's own defaults
};

void add_preparation_options(CLI::App& command, PointsPreparation& preparation);

/// What the preparation did.
struct PreparedPoints {
  std::uint64_t measured = 0;           ///< points before
  std::vector<Report> reports;          ///< of the operators that ran
  std::vector<std::uint32_t> original;  ///< index in the file of every point that is left; empty if all are
  std::vector<std::uint32_t> outliers;  ///< indices in the file of what `--remove-outliers` took

  /// Turns indices of the points that are left into indices in the file.
  void name_as_in_file(std::vector<std::uint32_t>& indices) const;
};

/// Removes outliers, then thins, in place. @throws as the operators do
PreparedPoints prepare(PointSet& points, const PointsPreparation& preparation, Context& context);

/// For reports: {"voxel": mm or null, "remove_outliers": bool}.
nlohmann::ordered_json to_json(const PointsPreparation& preparation);

/// Adds "points_used", "removed_outliers" and "preparation" (the operators' reports) if anything was asked for.
void add_to_report(nlohmann::ordered_json& report, const PreparedPoints& prepared);

/// One line for each operator that ran: what it took away.
std::string summary(const PreparedPoints& prepared);

}  // namespace tri::cli
