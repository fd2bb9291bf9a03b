#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "libtri/triangulate.hpp"

namespace tri::cli {

/// The report of `tri triangulate --report`. Face numbers are 1-based, point numbers 0-based, lengths mm.
nlohmann::ordered_json triangulate_report(const TriangulateResult& result, const CadModel& model, std::uint64_t points,
                                          const nlohmann::ordered_json& options);

/// The same in a few lines for a person: what was made, what was left out, what is not as the model has it.
std::string triangulate_summary(const TriangulateResult& result, const CadModel& model, std::uint64_t points);

const char* name_of(Method method);

}  // namespace tri::cli
