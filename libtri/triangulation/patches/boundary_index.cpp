#include "libtri/triangulation/patches/boundary_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tri {

BoundaryIndex::BoundaryIndex(const FaceDomain& domain, std::span<const double> reach)
    : reach_(reach.begin(), reach.end()) {
  Vec2 high(-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
  low_ = -high;
  double largest_reach = 0;
  for (const auto& loop : domain.loops)
    for (const CoedgeCurve& curve : loop) {
      largest_reach = std::max(largest_reach, reach_[static_cast<std::size_t>(curve.edge())]);
      for (const Vec2& p : curve.plane()) {
        low_.minimize(p);
        high.maximize(p);
      }
      for (std::size_t i = 0; i < curve.n_segments(); ++i) segments_.push_back({&curve, static_cast<std::uint32_t>(i)});
    }
  if (segments_.empty()) return;
  low_ -= Vec2(largest_reach, largest_reach);
  high += Vec2(largest_reach, largest_reach);
  const Vec2 size = high - low_;
  const double cell = std::max({size[0] / 1024, size[1] / 1024, 2 * largest_reach, 1e-300});
  per_cell_ = 1 / cell;
  columns_ = static_cast<int>(size[0] * per_cell_) + 1;
  rows_ = static_cast<int>(size[1] * per_cell_) + 1;
  cell_start_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  const auto for_cells = [&](const Segment& s, auto visit) {
    const double r = reach_[static_cast<std::size_t>(s.curve->edge())];
    const Vec2 &a = s.curve->plane()[s.index], &b = s.curve->plane()[s.index + 1];
    const auto range = [&](int k, int count) {
      const double from = (std::min(a[k], b[k]) - r - low_[k]) * per_cell_,
                   to = (std::max(a[k], b[k]) + r - low_[k]) * per_cell_;
      return std::pair(std::clamp(static_cast<int>(from), 0, count - 1),
                       std::clamp(static_cast<int>(to), 0, count - 1));
    };
    const auto [x0, x1] = range(0, columns_);
    const auto [y0, y1] = range(1, rows_);
    const Vec2 along = b - a;
    const double length = along.norm();
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        // A long slanted segment has a large box: leave out the cells that lie off its line.
        const Vec2 center = low_ + Vec2((x + 0.5) * cell_size(), (y + 0.5) * cell_size());
        const Vec2 d = center - a;
        if (length > 0 && std::abs(d[0] * along[1] - d[1] * along[0]) > (r + cell_size()) * length) continue;
        visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x));
      }
  };
  for (const Segment& s : segments_) for_cells(s, [&](std::size_t c) { ++cell_start_[c + 1]; });
  for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
  cell_segments_.resize(cell_start_.back());
  std::vector<std::uint32_t> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < segments_.size(); ++i)
    for_cells(segments_[i], [&](std::size_t c) { cell_segments_[next[c]++] = static_cast<std::uint32_t>(i); });
}

void BoundaryIndex::consider(const Segment& segment, const Vec2& p, bool any, Place& best) const {
  double distance;
  const double s = segment.curve->project(segment.index, p, distance);
  const int edge = segment.curve->edge();
  if (!any && distance > reach_[static_cast<std::size_t>(edge)]) return;
  if (best.edge < 0 || distance < best.distance) best = {edge, s, distance};
}

BoundaryIndex::Place BoundaryIndex::close(const Vec2& p) const {
  Place best;
  const double x = (p[0] - low_[0]) * per_cell_, y = (p[1] - low_[1]) * per_cell_;
  if (!(x >= 0 && y >= 0 && x < columns_ && y < rows_)) return best;
  const std::size_t cell =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  for (std::uint32_t i = cell_start_[cell]; i < cell_start_[cell + 1]; ++i)
    consider(segments_[cell_segments_[i]], p, false, best);
  return best;
}

BoundaryIndex::Place BoundaryIndex::closest(const Vec2& p) const {
  Place best;
  for (const Segment& s : segments_) consider(s, p, true, best);
  return best;
}

}  // namespace tri
