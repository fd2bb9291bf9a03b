#include "cli/points_input.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

namespace tri::cli {
namespace {

struct Unit {
  const char* name;
  double millimetres;
};

constexpr std::array units{Unit{"mm", 1},       Unit{"cm", 10},      Unit{"dm", 100},     Unit{"m", 1000},
                           Unit{"km", 1e6},     Unit{"um", 1e-3},    Unit{"nm", 1e-6},    Unit{"in", 25.4},
                           Unit{"inch", 25.4},  Unit{"ft", 304.8},   Unit{"foot", 304.8}, Unit{"yd", 914.4},
                           Unit{"mil", 0.0254}, Unit{"thou", 0.0254}};

void to_millimetres(PointSet& set, const std::string& path, const PointUnits& point_units, const PointsFileInfo& info,
                    const Program& program) {
  const double factor = factor_of(point_units, info);
  scale(set, factor);
  if (!program.quiet && factor != 1 && point_units.given == "auto")
    print_note(
        fmt::format("{}: in {}, as its format defines: converted to millimetres (--units mm takes the numbers as "
                    "they are)",
                    path, info.unit));
  if (!program.quiet && info.format == PointsFormat::ptx && point_units.given == "auto")
    print_note(fmt::format("{}: taken as millimetres; many programs write PTX in metres (--units m)", path));
}

}  // namespace

double millimetres_per(const std::string& unit) {
  if (unit == "auto") return 0;
  for (const Unit& known : units)
    if (unit == known.name) return known.millimetres;
  double value = 0;
  if (CLI::detail::lexical_cast(unit, value) && value > 0 && std::isfinite(value)) return value;
  std::string names;
  for (const Unit& known : units) names += std::string(names.empty() ? "" : ", ") + known.name;
  throw UsageError(fmt::format("--units {}: neither one of {} nor a number of millimetres above 0", unit, names));
}

void add_units_option(CLI::App& command, PointUnits& point_units) {
  command
      .add_option(
          "--units", point_units.given,
          "Unit of the points: mm, cm, m, um, inch, ft …, or millimetres per unit (25.4). auto: what the format "
          "defines (E57: m), else mm")
      ->check(CLI::Validator(
          [](std::string& text) {
            try {
              millimetres_per(text);
            } catch (const UsageError& e) {
              return std::string(e.what());
            }
            return std::string();
          },
          "UNIT"))
      ->capture_default_str();
}

double factor_of(const PointUnits& point_units, const PointsFileInfo& info) {
  const double given = millimetres_per(point_units.given);
  if (given > 0) return given;
  return info.unit.empty() ? 1 : millimetres_per(info.unit);
}

PointSet read_points_in_mm(const std::string& path, const PointUnits& point_units, Program& program,
                           PointsFileInfo* info) {
  PointsFileInfo own;
  PointsFileInfo& what = info ? *info : own;
  PointSet set = read_points(path, program.context, &what);
  to_millimetres(set, path, point_units, what, program);
  return set;
}

PointsInBackground::PointsInBackground(std::string path, PointUnits point_units, Program& program)
    : path_(std::move(path)), units_(std::move(point_units)), program_(program) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path_, error)) return;
  quiet_.threads = program.context.threads;
  quiet_.on_log = [this](std::string_view line) { log_.emplace_back(line); };
  quiet_.on_checkpoint = [this] {
    if (program_.context.cancelled()) quiet_.cancel();
  };
  points_ = std::async(std::launch::async, [this] { return read_points(path_, quiet_, &info_); });
}

PointsInBackground::~PointsInBackground() {
  quiet_.cancel();
}

PointSet PointsInBackground::get(PointsFileInfo* info) {
  if (!points_.valid()) return read_points_in_mm(path_, units_, program_, info);
  PointSet set = points_.get();
  for (const std::string& line : log_) program_.context.log(line);
  to_millimetres(set, path_, units_, info_, program_);
  if (info) *info = std::move(info_);
  return set;
}

nlohmann::ordered_json to_json(const PointUnits& point_units, const PointsFileInfo& info) {
  return {{"units", point_units.given}, {"mm_per_unit", factor_of(point_units, info)}};
}

}  // namespace tri::cli
