#include "cli/alignment.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <utility>

#include "cli/number_checks.hpp"
#include "io/pose_file.hpp"
#include "libtri/alignment/probe.hpp"

namespace tri::cli {
using Json = nlohmann::ordered_json;

void add_align_options(CLI::App& command, AlignInput& input) {
  command
      .add_option(
          "--align", input.mode,
          "auto: points that lie on the model stay, any others are aligned from nothing; icp: refined from where "
          "they are, or from --pose or --pairs; none: taken as they are, or as --pose or --pairs say")
      ->check(CLI::IsMember({"auto", "icp", "none"}))
      ->capture_default_str();
  auto* pose =
      command
          .add_option("--pose", input.pose,
                      "Start from the pose in this JSON file: {\"matrix\": [[4x4]]}, or the report of an alignment")
          ->type_name("FILE");
  command
      .add_option(
          "--pairs", input.pairs,
          "Start from three or more pairs of points: a text file with x y z X Y Z on each line, measured and in "
          "the model's frame (mm)")
      ->type_name("FILE")
      ->excludes(pose);
  command.add_option("--seed", input.seed, "Of the random choices of the search; the same seed gives the same pose")
      ->capture_default_str();
  command
      .add_option(
          "--probe-radius", input.probe_radius,
          "The points are centres of a ball of this radius in mm that touched the part: they are fitted so far off "
          "the model; `align` keeps the centres, the other commands go on with the places that the ball touched")
      ->check(not_negative())
      ->capture_default_str();
}

AlignOptions align_options(const AlignInput& input, double factor) {
  AlignOptions options;
  options.mode = align_mode(input.mode);
  options.seed = input.seed;
  options.probe_radius = input.probe_radius;
  if (!input.pose.empty()) options.start = read_pose(input.pose);
  if (!input.pairs.empty()) {
    PointPairs pairs = read_pairs(input.pairs);
    for (Vec3& p : pairs.points) p *= factor;
    options.start = fit_pose(pairs.points, pairs.places);
  }
  return options;
}

Json to_json(const AlignInput& input) {
  Json json{{"align", input.mode},
            {"pose", nullptr},
            {"pairs", nullptr},
            {"seed", input.seed},
            {"probe_radius", input.probe_radius}};
  if (!input.pose.empty()) json["pose"] = input.pose;
  if (!input.pairs.empty()) json["pairs"] = input.pairs;
  return json;
}

std::string alignment_text(const AlignResult& r) {
  const MotionParts parts = parts_of(r.pose, Vec3(0, 0, 0));
  std::string text = fmt::format("alignment: {}", name_of(r.status));
  if (r.pose.is_identity())
    text += r.kept ? ", the points already lie on the model and stay as they are\n" : "\n";
  else
    text += fmt::format(", turned by {:.4g} degrees about {}, then moved by {} mm\n",
                        parts.angle * 180 / 3.14159265358979, in_words(parts.axis), in_words(r.pose.translation));
  text += fmt::format(
      "fit: rms {:.4g} mm of the {:.4g}% of points within the noise, median {:.4g} mm; {:.3g}% of the model is "
      "near a point; {} iterations\n",
      r.quality.rms, 100 * r.quality.inlier_share, r.quality.median, 100 * r.coverage, r.iterations);
  for (const std::string& reason : r.reasons) text += reason + "\n";
  for (const std::string& note : r.notes) text += note + "\n";
  return text;
}

std::string unit_option(const AlignResult& result, double factor) {
  constexpr std::array<std::pair<const char*, double>, 5> names{
      {{"mm", 1}, {"cm", 10}, {"m", 1000}, {"inch", 25.4}, {"ft", 304.8}}};
  const double wanted = factor * result.unit_factor;
  for (const auto& [name, millimetres] : names)
    if (std::abs(wanted - millimetres) < 1e-6 * millimetres) return fmt::format("--units {}", name);
  return fmt::format("--units {:.6g}", wanted);
}

void require_fit(const AlignResult& result, double factor) {
  if (result.status != AlignStatus::failed) return;
  std::string text;
  for (const std::string& reason : result.reasons) text += (text.empty() ? "" : "; ") + reason;
  if (result.unit_factor != 1) text += ": " + unit_option(result, factor);
  throw Error(text);
}

std::optional<AlignResult> align_points(const AlignInput& input, const CadModel& model,
                                        const Registration& registration, std::vector<Vec3>& points,
                                        std::vector<Vec3>& normals, double factor, Context& context) {
  const AlignOptions options = align_options(input, factor);
  std::optional<AlignResult> result;
  if (options.mode != AlignMode::none || options.start) {
    result = align(model, registration, points, normals, options, context);
    // A pose that was given is the user's to judge; the deviations say how well it fits.
    if (options.mode != AlignMode::none) require_fit(*result, factor);
    if (!result->pose.is_identity()) {
      for (Vec3& p : points) p = result->pose(p);
      for (Vec3& n : normals) n = result->pose.turn(n);
    }
  }
  if (options.probe_radius > 0) points = touched_places(registration, points, options.probe_radius, context);
  return result;
}

}  // namespace tri::cli
