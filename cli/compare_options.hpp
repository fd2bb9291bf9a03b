#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/points_input.hpp"
#include "cli/program.hpp"
#ifdef TRI_WITH_CAD
#include "cli/alignment.hpp"
#include "cli/model_input.hpp"
#endif
#include "io/html/html_report.hpp"
#include "meshops/checks/value_statistics.hpp"
#include "meshops/soup.hpp"

namespace tri::cli {

/// The command line of `tri compare`.
struct CompareOptions {
  std::vector<std::string> inputs;  ///< what is measured, and without a CAD model the mesh it is compared with
  std::string output, csv;
  std::vector<std::string> reports;  ///< .json and .html
  PointUnits units;
  std::optional<Tolerance> tolerance;
  double max_distance = 0;    ///< mm; 0 for none
  std::uint64_t samples = 0;  ///< 0 for the default
  std::uint64_t seed = 1;
  bool json = false;
#ifdef TRI_WITH_CAD
  ModelInput model;
  AlignInput align{.mode = "none"};
#endif
};

/// A mesh or points in millimetres; points are a soup without triangles.
/// @param factor  if given, receives the millimetres per unit of the file
Soup read_measured(const std::string& path, const CompareOptions& options, Program& program, double* factor = nullptr);

/// The options as every report states them.
nlohmann::ordered_json to_json(const CompareOptions& options);

/// What a comparison found, in every form that may be asked for.
struct CompareResults {
  Soup colored;  ///< for --output; given up to be written
  nlohmann::ordered_json json;
  std::string csv, text;
  std::function<HtmlReport()> page;  ///< called only if a page is asked for; it shows what outlives the call
};

/// Paints the vertices by the scalar "deviation".
void paint(Soup& soup, const DeviationScale& scale);

/// Writes whatever the command line asks for and says the rest on standard output. @return exit_done
int finish(const CompareOptions& options, Program& program, CompareResults& results);

/// Each runs one kind of comparison. @return the exit code
int compare_with_model(const CompareOptions& options, Program& program);
int compare_meshes(const CompareOptions& options, Program& program);

}  // namespace tri::cli
