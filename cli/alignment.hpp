#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/points_input.hpp"
#include "cli/program.hpp"
#include "io/result_json.hpp"
#include "libtri/alignment/align.hpp"

namespace tri::cli {

/// The alignment options of every command that takes measured points to a CAD model.
struct AlignInput {
  std::string mode = "auto", pose, pairs;
  std::uint64_t seed = 1;
  double probe_radius = 0;  ///< mm
};

/// Adds --align, --pose, --pairs, --seed and --probe-radius to a command.
void add_align_options(CLI::App& command, AlignInput& input);

/// What they say; reads the files they name.
/// @param factor  millimetres per unit of the points, by which the points of --pairs are multiplied
/// @throws IoError, InvalidInput (pairs on one line)
AlignOptions align_options(const AlignInput& input, double factor);

/// For reports.
nlohmann::ordered_json to_json(const AlignInput& input);

/// What happened, for a person; several lines.
std::string alignment_text(const AlignResult& result);

/// "--units inch", where the points seem to be in another unit than the one they were read in.
/// @param factor  millimetres per unit as they were read
std::string unit_option(const AlignResult& result, double factor);

/// @throws Error with numbers if the points do not fit the model. @param factor as `unit_option`
void require_fit(const AlignResult& result, double factor);

/// Moves points and normals onto the model as the options say, not at all where they are to be taken as they are.
/// Centres of a probe's ball become the places that it touched.
/// @param normals  of the points, or empty @param factor  as `unit_option`
/// @throws Error if they do not fit, and as `align_options` and `align`
std::optional<AlignResult> align_points(const AlignInput& input, const CadModel& model,
                                        const Registration& registration, std::vector<Vec3>& points,
                                        std::vector<Vec3>& normals, double factor, Context& context);

}  // namespace tri::cli
