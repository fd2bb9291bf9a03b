#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/points_input.hpp"
#include "meshops/context.hpp"
#include "meshops/vec.hpp"

namespace tri::cli {

/// What is known of a file, ready to be shown: lines for a person, keys for a machine.
struct Info {
  std::vector<std::pair<std::string, std::string>> lines;  ///< label and text
  std::vector<std::string> notes;                          ///< whole sentences, shown below
  nlohmann::ordered_json json;

  /// Adds a line.
  void line(const std::string& label, const std::string& text) { lines.emplace_back(label, text); }
};

/// Adds the bounding box, as lines and as "box_min", "box_max", "diagonal".
void add_box(Info& info, const Vec3& low, const Vec3& high);

/// Each reads a file of its kind.
/// @throws IoError, CadError, Cancelled
Info mesh_info(const std::string& path, Context& context);
/// Lengths are in millimetres.
Info points_info(const std::string& path, const PointUnits& units, Program& program);
/// @param sew_tolerance mm
Info cad_info(const std::string& path, double sew_tolerance, Context& context);

}  // namespace tri::cli
