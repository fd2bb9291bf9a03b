#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "cli/program.hpp"
#include "io/html/html_report.hpp"
#include "io/measure_json.hpp"
#include "meshops/checks/value_statistics.hpp"

namespace tri::cli {

/// What the reports of deviations have in common.

/// The colours that show these values: to the ends of the tolerance, or without one as far as 98% of them reach.
DeviationScale scale_of(std::span<const double> values, const std::optional<Tolerance>& tolerance);
/// The same in one sentence.
std::string scale_note(const DeviationScale& scale, const std::string& unit);

/// A field of a CSV file [RFC 4180].
std::string csv_field(const std::string& text);

/// The share in tolerance, "98.81 %"; empty without a value.
std::string percent(const ValueStatistics& s);
/// "-0.1 to +0.1 mm", or "none given".
std::string tolerance_text(const std::optional<Tolerance>& tolerance);
/// A place of a part of this size, in mm.
std::string place_text(const Vec3& p, double diagonal);
/// A path without its folders.
std::string file_name(const std::string& path);
/// The time of day and date, UTC.
std::string date_now();

/// From the scale's ends or the bulk of the values, whichever reaches farther, with some air; nothing without a value.
std::optional<Histogram> histogram_to_show(std::span<const double> values, const DeviationScale& scale);
/// True if a report of this name is a page: it ends in .html or .htm.
bool is_page(const std::string& path);
/// Writes it, and says on standard error if the program cannot make one that turns.
void write_page(const std::string& path, const HtmlReport& page, const Program& program);

/// The options of a command as the last block of a page.
std::pair<std::string, std::string> options_block(const nlohmann::ordered_json& options);

}  // namespace tri::cli
