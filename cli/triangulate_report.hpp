#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "io/html/html_report.hpp"
#include "io/result_json.hpp"
#include "libtri/triangulation/triangulate.hpp"

namespace tri::cli {

/// The report of `tri triangulate --report`. Face numbers are 1-based, point numbers 0-based, lengths mm.
nlohmann::ordered_json triangulate_report(const TriangulateResult& result, const CadModel& model, std::uint64_t points,
                                          const nlohmann::ordered_json& options);

/// The same in a few lines for a person: what was made, what was left out, what is not as the model has it.
std::string triangulate_summary(const TriangulateResult& result, const CadModel& model, std::uint64_t points);

/// What was triangulated, for the page.
struct TriangulateInputs {
  std::string cad, points;  ///< the files
  std::uint64_t count = 0;  ///< of the points
  nlohmann::ordered_json options;
  std::string alignment;  ///< what happened to the points before; may be empty
};

/// The result as a page: the deviations of the vertices as `tri compare` has them, and what the summary says.
/// @param mesh  of the result, as it is written; shown by the page, so it must outlive it
HtmlReport triangulate_page(const TriangulateResult& result, const CadModel& model, const TriangulateInputs& inputs,
                            const Soup& mesh, const Context& context);

}  // namespace tri::cli
