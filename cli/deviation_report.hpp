#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/html_report.hpp"
#include "libtri/deviation.hpp"

namespace tri::cli {

/// A comparison with a CAD model, for the reports below.
struct DeviationReport {
  std::string cad, measured;              ///< the files
  std::uint64_t triangles = 0;            ///< of the measured mesh; 0 if points were measured
  const CadModel* model = nullptr;
  const Deviations* deviations = nullptr;
  DeviationOptions options;
  DeviationScale scale;
  nlohmann::ordered_json options_json;    ///< as the command was called
  std::vector<std::pair<std::string, std::string>> facts;  ///< more of them for the head of the page: label and text
  std::vector<std::pair<std::string, std::string>> blocks; ///< further title and text for the page: the pose
  std::vector<std::string> notes;         ///< what a reader must know
};

/// The colours that show these deviations: to the ends of the tolerance, or without one as far as 98% of the points reach.
DeviationScale scale_of(const Deviations& deviations, const DeviationOptions& options);
/// The same in one sentence.
std::string scale_note(const DeviationScale& scale, const std::string& unit);

/// {"points", "mean", "rms", …} of `tri compare --json`.
nlohmann::ordered_json to_json(const ValueStatistics& s, bool tolerance);

/// The report as JSON, as a table with one line a face (and one for all) in CSV, and for a person.
nlohmann::ordered_json deviation_json(const DeviationReport& report);
std::string deviation_csv(const DeviationReport& report);
std::string deviation_text(const DeviationReport& report);

/// The report as a page, without its picture: `scene` and `backdrop` are left to the caller.
/// @param feet  of every point, for the pins
HtmlReport deviation_page(const DeviationReport& report, std::span<const Foot> feet);

/// The time of day and date for the head of a page, UTC.
std::string date_now();

}  // namespace tri::cli
