#include "libtri/alignment/verdict.hpp"

#include <fmt/format.h>

namespace tri {
namespace {

// Beyond these the points do not fit the model at all …
constexpr double failed_median = 5e-3;      // of the size
constexpr double failed_near = 0.5;         // share of the points within 0.5% of the size
constexpr double failed_systematic = 5e-3;  // of the size
constexpr double failed_coherent = 0.25;    // share of the points
// … and beyond these it is not certain that the pose is right.
constexpr double doubtful_median = 2e-3;      // of the size
constexpr double doubtful_inliers = 0.6;      // share of the points
constexpr double doubtful_coherent = 0.03;    // share of the points
constexpr double doubtful_systematic = 1e-3;  // of the size

}  // namespace

bool fits(const FitQuality& q, double size) {
  return q.median <= doubtful_median * size && q.inlier_share >= doubtful_inliers &&
         q.coherent_share <= doubtful_coherent && q.systematic <= doubtful_systematic * size;
}

void judge(AlignResult& result, std::size_t points, double size) {
  const FitQuality& q = result.quality;
  const auto because = [&](std::string reason) { result.reasons.push_back(std::move(reason)); };
  const auto percent = [](double share) { return 100 * share; };
  result.status = AlignStatus::good;
  if (q.median > failed_median * size || q.near_share < failed_near || q.coherent_share > failed_coherent ||
      q.systematic > failed_systematic * size) {
    result.status = AlignStatus::failed;
    because(fmt::format(
        "the points do not fit the model: half of {} points are farther than {:.4g} mm from it ({:.2g}% of the "
        "size), {:.3g}% are within 0.5% of it, {:.3g}% lie off it in whole regions",
        points, q.median, percent(q.median / size), percent(q.near_share), percent(q.coherent_share)));
    return;
  }
  if (q.median > doubtful_median * size || q.systematic > doubtful_systematic * size)
    because(fmt::format(
        "the points deviate from the model together, by {:.3g} mm rms ({:.2g}% of its size): a deformed part, "
        "another part, or a wrong pose",
        q.systematic, percent(q.systematic / size)));
  if (q.inlier_share < doubtful_inliers)
    because(fmt::format("only {:.3g}% of the points lie within the noise of the model", percent(q.inlier_share)));
  if (q.coherent_share > doubtful_coherent)
    because(fmt::format(
        "{:.3g}% of the points lie off the model in whole regions: something else was measured too, the part is "
        "deformed, or the pose is wrong",
        percent(q.coherent_share)));
  for (const Freedom& f : result.information.freedoms) because("not fixed by the points: the part " + f.in_words());
  for (const auto& weak : result.information.weak)
    because(fmt::format("fixed only to a standard deviation of {:.3g} mm: the part {}", weak.standard_deviation,
                        weak.motion.in_words()));
  if (!result.alternatives.empty()) {
    std::string text =
        fmt::format("{} other pose{} fit{} as well: the part ", result.alternatives.size(),
                    result.alternatives.size() > 1 ? "s" : "", result.alternatives.size() > 1 ? "" : "s");
    for (std::size_t i = 0; i < result.alternatives.size(); ++i)
      text += (i > 0 ? "; " : "") + result.alternatives[i].words;
    because(text);
  }
  if (!result.reasons.empty()) result.status = AlignStatus::ambiguous;
}

}  // namespace tri
