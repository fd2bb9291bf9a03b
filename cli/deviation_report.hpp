#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/html/html_report.hpp"
#include "libtri/deviation.hpp"

namespace tri::cli {

/// A comparison with a CAD model, for the reports below.
struct DeviationReport {
  std::string cad, measured;    ///< the files
  std::uint64_t triangles = 0;  ///< of the measured mesh; 0 if points were measured
  const CadModel* model = nullptr;
  const Deviations* deviations = nullptr;
  DeviationOptions options;
  DeviationScale scale;
  nlohmann::ordered_json options_json;                      ///< as the command was called
  std::vector<std::pair<std::string, std::string>> facts;   ///< more of them for the head of the page: label and text
  std::vector<std::pair<std::string, std::string>> blocks;  ///< further title and text for the page: the pose
  nlohmann::ordered_json alignment;                         ///< for the JSON report; null if nothing was aligned
  std::vector<std::string> notes;                           ///< what a reader must know
};

/// The report as JSON, as a table with one line a face (and one for all) in CSV, and for a person.
inline const char* name_of_one(const DeviationReport& r) {
  return r.triangles > 0 ? "vertex" : "point";
}
inline const char* name_of_many(const DeviationReport& r) {
  return r.triangles > 0 ? "vertices" : "points";
}

nlohmann::ordered_json deviation_json(const DeviationReport& report);
std::string deviation_csv(const DeviationReport& report);
std::string deviation_text(const DeviationReport& report);

/// The report as a page, without its picture: `scene` and `backdrop` are left to the caller.
/// @param feet  of every point, for the pins
HtmlReport deviation_page(const DeviationReport& report, std::span<const Foot> feet);

}  // namespace tri::cli
