#include "meshops/joining/contour_triangulation.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace tri {
namespace {

using IndexPair = std::pair<int, int>;

class ContourStrip {
 public:
  ContourStrip(std::span<const Vec3> first, std::span<const Vec3> second,
               const std::function<bool(int, int, ContourStep)>& allowed)
      : first_(first), second_(second), allowed_(allowed), m_(static_cast<int>(first.size()) - 1),
        n_(static_cast<int>(second.size()) - 1) {}

  std::optional<std::vector<ContourStep>> run() {
    if (m_ < 0 || n_ < 0 || m_ + n_ < 1) return std::nullopt;
    auto steps = by_arc_length(cuts());
    if (!steps) steps = by_diagonal(true);
    return steps;
  }

 private:
  double diagonal(int i, int j) const { return (first_[i] - second_[j]).norm(); }
  bool may(int i, int j, ContourStep step, bool asked) const { return !asked || !allowed_ || allowed_(i, j, step); }

  std::optional<std::vector<ContourStep>> by_diagonal(bool asked) const {
    std::vector<ContourStep> steps;
    int i = 0, j = 0;
    while (i < m_ || j < n_) {
      const bool a = i < m_ && may(i, j, ContourStep::first, asked),
                 b = j < n_ && may(i, j, ContourStep::second, asked);
      if (!a && !b) return std::nullopt;
      if (a && (!b || diagonal(i + 1, j) <= diagonal(i, j + 1))) {
        steps.push_back(ContourStep::first);
        ++i;
      } else {
        steps.push_back(ContourStep::second);
        ++j;
      }
    }
    return steps;
  }

  /// Diagonals between mutually nearest vertices, in order, from (0, 0) to (m, n).
  std::vector<IndexPair> cuts() const {
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<std::pair<double, int>> of_first(m_ + 1, {infinity, -1}), of_second(n_ + 1, {infinity, -1});
    const auto walk = by_diagonal(false);
    int i = 0, j = 0;
    const auto meet = [&] {
      const double d = diagonal(i, j);
      if (d < of_first[i].first) of_first[i] = {d, j};
      if (d < of_second[j].first) of_second[j] = {d, i};
    };
    meet();
    for (const ContourStep s : *walk) {
      ++(s == ContourStep::first ? i : j);
      meet();
    }
    std::vector<IndexPair> result{{0, 0}};
    for (int a = 0; a <= m_; ++a) {
      const int b = of_first[a].second;
      if (of_second[b].second == a && a > result.back().first && b > result.back().second && a < m_ && b < n_)
        result.push_back({a, b});
    }
    result.push_back({m_, n_});
    return result;
  }

  std::optional<std::vector<ContourStep>> by_arc_length(const std::vector<IndexPair>& cuts) const {
    const auto lengths = [](std::span<const Vec3> contour) {
      std::vector<double> sum(contour.size(), 0);
      for (std::size_t k = 1; k < contour.size(); ++k) sum[k] = sum[k - 1] + (contour[k] - contour[k - 1]).norm();
      return sum;
    };
    const std::vector<double> s = lengths(first_), t = lengths(second_);
    std::vector<ContourStep> steps;
    for (std::size_t c = 1; c < cuts.size(); ++c) {
      const auto [i0, j0] = cuts[c - 1];
      const auto [i1, j1] = cuts[c];
      const auto share = [](const std::vector<double>& sum, int from, int to, int at) {
        const double whole = sum[to] - sum[from];
        return whole > 0 ? (sum[at] - sum[from]) / whole : 0.0;
      };
      int i = i0, j = j0;
      while (i < i1 || j < j1) {
        const bool a = i < i1 && may(i, j, ContourStep::first, true),
                   b = j < j1 && may(i, j, ContourStep::second, true);
        if (!a && !b) return std::nullopt;
        bool take_first = a;
        if (a && b) {
          const double off_first = std::abs(share(s, i0, i1, i + 1) - share(t, j0, j1, j));
          const double off_second = std::abs(share(s, i0, i1, i) - share(t, j0, j1, j + 1));
          // Equal but for rounding: the shorter diagonal.
          take_first = std::abs(off_first - off_second) > 1e-12 ? off_first < off_second
                                                                : diagonal(i + 1, j) <= diagonal(i, j + 1);
        }
        steps.push_back(take_first ? ContourStep::first : ContourStep::second);
        ++(take_first ? i : j);
      }
    }
    return steps;
  }

  std::span<const Vec3> first_, second_;
  const std::function<bool(int, int, ContourStep)>& allowed_;
  int m_, n_;
};

}  // namespace

std::optional<std::vector<ContourStep>> triangulate_contours(
    std::span<const Vec3> first, std::span<const Vec3> second,
    const std::function<bool(int, int, ContourStep)>& allowed) {
  return ContourStrip(first, second, allowed).run();
}

}  // namespace tri
