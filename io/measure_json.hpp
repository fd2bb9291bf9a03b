#pragma once

#include <nlohmann/json.hpp>

#include "meshops/checks/mesh_distance.hpp"
#include "meshops/checks/value_statistics.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// Results as JSON, with the names that the reports of the program have.

/// [x, y, z]
nlohmann::ordered_json point_json(const Vec3& p);

/// {"points", "mean", "rms", …}: null where there is no point. @param tolerance  whether there is one
nlohmann::ordered_json statistics_json(const ValueStatistics& s, bool tolerance);

/// {"hausdorff", "hausdorff_bound", "mean", "rms", "forward", "backward"}, lengths in model units.
nlohmann::ordered_json to_json(const MeshDistance& distance);

}  // namespace tri
