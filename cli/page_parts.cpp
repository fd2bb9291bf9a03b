#include "cli/page_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "io/html/html_text.hpp"
#include "io/input_file.hpp"

namespace tri::cli {
namespace {

constexpr int bins = 60;
constexpr double smallest_scale = 1e-6;  // mm, where nothing deviates

}  // namespace

DeviationScale scale_of(std::span<const double> values, const std::optional<Tolerance>& tolerance) {
  if (tolerance) return {tolerance->low, tolerance->high, true};
  const double reach = std::max(range_to_show(values), smallest_scale);
  return {-reach, reach, false};
}

std::string scale_note(const DeviationScale& scale, const std::string& unit) {
  if (scale.tolerance)
    return fmt::format("The colours end at the tolerance, {:+} to {:+} {}; beyond it they are cyan and magenta.",
                       scale.low, scale.high, unit);
  return fmt::format("No tolerance was given: the colours end at {0:+} and {1:+} {2}, which 98% do not exceed.",
                     scale.low, scale.high, unit);
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

std::string percent(const ValueStatistics& s) {
  return s.count == 0
             ? ""
             : fmt::format("{:.2f} %", 100.0 * static_cast<double>(s.in_tolerance) / static_cast<double>(s.count));
}

std::string tolerance_text(const std::optional<Tolerance>& tolerance) {
  return tolerance ? fmt::format("{:+g} to {:+g} mm", tolerance->low, tolerance->high) : "none given";
}

std::string place_text(const Vec3& p, double diagonal) {
  const int decimals = decimals_for(diagonal);
  return fmt::format("{:.{}f}, {:.{}f}, {:.{}f}", p[0], decimals, p[1], decimals, p[2], decimals);
}

std::string file_name(const std::string& path) {
  const auto slash = path.rfind('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

std::string date_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

std::optional<Histogram> histogram_to_show(std::span<const double> values, const DeviationScale& scale) {
  if (values.empty()) return std::nullopt;
  std::vector<double> order(values.begin(), values.end());
  double low = std::min(scale.low, percentile(order, 0.002)), high = std::max(scale.high, percentile(order, 0.998));
  const double air = 0.05 * (high - low);
  low -= air, high += air;
  return histogram(values, low, high, bins);
}

bool is_page(const std::string& path) {
  const std::string extension = file_extension(path);
  return extension == "html" || extension == "htm";
}

void write_page(const std::string& path, const HtmlReport& page, const Program& program) {
  Context uncancelled;  // an interrupt between two files would leave half of the result
  write_html(path, page, uncancelled);
  if (!html_can_turn() && !program.quiet)
    print_note(path + ": the part cannot be turned, as this program was built without three.js (Debian: libjs-three)");
}

std::pair<std::string, std::string> options_block(const nlohmann::ordered_json& options) {
  return {"Options", options.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace)};
}

}  // namespace tri::cli
