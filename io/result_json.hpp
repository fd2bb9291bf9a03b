#pragma once

#include <nlohmann/json.hpp>

#include "io/measure_json.hpp"
#include "libtri/alignment/align.hpp"
#include "libtri/deviation.hpp"
#include "libtri/triangulation/triangulate.hpp"

namespace tri {

/// Results of the work with a CAD model as JSON, with the names that the reports of the program have. Face numbers are
/// 1-based, point numbers 0-based, lengths mm, angles radians.

/// "auto", "patches" or "shell".
const char* name_of(Method method);

/// The report of an alignment, as `tri align --report` writes it.
nlohmann::ordered_json to_json(const AlignResult& result);

/// Everything but the mesh. @param model  the one that was triangulated on
nlohmann::ordered_json to_json(const TriangulateResult& result, const CadModel& model);

/// "overall", "faces", "far", "worst" and "unusable_faces"; not the values of every point.
/// @param options  those that the deviations were taken with
nlohmann::ordered_json to_json(const Deviations& deviations, const CadModel& model, const DeviationOptions& options);

}  // namespace tri
