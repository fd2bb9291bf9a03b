#include "libtri/sampling/sampling_patterns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

namespace tri {
namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

}  // namespace

AreaSampler::AreaSampler(const SamplingModel& model, Context& context) : model_(model) {
  const auto& facets = model.facets();
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    if (f % 1024 == 0) context.checkpoint();
    const auto& n = facets[f].nodes;
    add(f, {model.nodes()[n[0]].uv, model.nodes()[n[1]].uv, model.nodes()[n[2]].uv}, 0);
  }
  cumulative_.reserve(cells_.size());
  double sum = 0;
  for (const Cell& cell : cells_) {
    const auto& c = cell.corners;
    cumulative_.push_back(sum += 0.5 * std::abs(cross(c[1] - c[0], c[2] - c[0])) * cell.bound);
  }
}

void AreaSampler::add(std::uint32_t facet, const std::array<Vec2, 3>& c, int depth) {
  constexpr int deepest = 6;
  constexpr double even = 1.25;  // cells vary no more than this, or are split
  const std::int32_t face = model_.facets()[facet].face;
  const std::array<Vec2, 3> middle = {(c[1] + c[2]) * 0.5, (c[2] + c[0]) * 0.5, (c[0] + c[1]) * 0.5};
  double low = std::numeric_limits<double>::infinity(), high = 0, sum = 0;
  for (int k = 0; k < 7; ++k) {
    const Vec2 at = k < 3 ? c[k] : k < 6 ? middle[k - 3] : (c[0] + c[1] + c[2]) / 3.0;
    const double stretch = model_.sample(face, at).stretch;
    low = std::min(low, stretch);
    high = std::max(high, stretch);
    sum += stretch / 7;
  }
  if (high > even * low && depth < deepest) {
    add(facet, {c[0], middle[2], middle[1]}, depth + 1);
    add(facet, {c[1], middle[0], middle[2]}, depth + 1);
    add(facet, {c[2], middle[1], middle[0]}, depth + 1);
    add(facet, middle, depth + 1);
    return;
  }
  const double extent = 0.5 * std::abs(cross(c[1] - c[0], c[2] - c[0]));
  area_ += extent * sum;
  // Seven places may miss the largest value, by less than the variation that is allowed.
  if (extent > 0 && high > 0) cells_.push_back({facet, c, high + 0.5 * (high - low) + 1e-9 * high});
}

bool AreaSampler::draw(RandomStream& random, const std::function<bool(const SamplingModel::Sample&)>& accept,
                       int max_tries, SurfacePlace& place, SamplingModel::Sample& sample) const {
  if (cells_.empty()) return false;
  for (int i = 0; i < max_tries; ++i) {
    const double at = random.uniform() * cumulative_.back();
    const std::size_t index = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, at) - cumulative_.begin();
    const Cell& cell = cells_[index];
    double a = random.uniform(), b = random.uniform();
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    const double level = random.uniform();
    const SamplingModel::Facet& facet = model_.facets()[cell.facet];
    place = {facet.face,
             cell.corners[0] + (cell.corners[1] - cell.corners[0]) * a + (cell.corners[2] - cell.corners[0]) * b};
    sample = model_.sample(facet.face, place.uv);
    if (level * cell.bound > sample.stretch || !model_.inside(facet, place.uv)) continue;
    if (accept(sample)) return true;
  }
  return false;
}

ScanLines::ScanLines(const SamplingModel& model, const Vec3& travel, const Vec3& second, double distance,
                     RandomStream random)
    : model_(model) {
  constexpr double too_steep = 0.8;  // sine of the least angle between surface and planes: 37 degrees
  std::vector<std::uint32_t> first_set, second_set;
  for (std::uint32_t f = 0; f < model.facets().size(); ++f) {
    const auto& n = model.facets()[f].nodes;
    const Vec3 a = model.nodes()[n[0]].point, b = model.nodes()[n[1]].point, c = model.nodes()[n[2]].point;
    const Vec3 normal = (b - a) % (c - a);
    (std::abs(normal | travel) <= too_steep * normal.norm() ? first_set : second_set).push_back(f);
  }
  distance_ = distance;
  cut(travel, first_set, distance, random);
  cut(second, second_set, distance, random);
  for (const Piece& piece : pieces_) length_ += piece.length;
}

void ScanLines::cut(const Vec3& travel, const std::vector<std::uint32_t>& facets, double distance,
                    RandomStream& random) {
  const auto& nodes = model_.nodes();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::uint32_t f : facets) {
    for (const std::uint32_t n : model_.facets()[f].nodes) {
      const double height = nodes[n].point | travel;
      low = std::min(low, height);
      high = std::max(high, height);
    }
  }
  if (!(high > low)) return;
  // Planes at low + (k + shift) * distance, so that the first is within the model even if there is but one.
  const double shift = random.uniform(0.25, 0.75) * std::min(1.0, (high - low) / distance);
  struct End {
    std::uint32_t a, b;  // the facet's edge that the plane crosses
    bool operator<(const End& o) const { return a != o.a ? a < o.a : b < o.b; }
  };
  struct Cut {
    Piece piece;
    std::array<End, 2> ends;
  };
  std::map<std::int64_t, std::vector<Cut>> planes;
  for (const std::uint32_t f : facets) {
    const auto& n = model_.facets()[f].nodes;
    double height[3];
    for (int k = 0; k < 3; ++k) height[k] = ((nodes[n[k]].point | travel) - low) / distance - shift;
    const auto [least, most] = std::minmax({height[0], height[1], height[2]});
    for (auto plane = static_cast<std::int64_t>(std::ceil(least)); plane <= most; ++plane) {
      Cut cut{{f, {}, {}, 0}, {}};
      Vec3 points[2];
      int found = 0;
      for (int k = 0; k < 3 && found < 2; ++k) {
        std::uint32_t i = n[k], j = n[(k + 1) % 3];
        double p = height[k] - double(plane), q = height[(k + 1) % 3] - double(plane);
        if ((p >= 0) == (q >= 0)) continue;
        if (i > j) {  // both facets at an edge compute the same place
          std::swap(i, j);
          std::swap(p, q);
        }
        const double t = p / (p - q);
        (found == 0 ? cut.piece.from : cut.piece.to) = nodes[i].uv + (nodes[j].uv - nodes[i].uv) * t;
        points[found] = nodes[i].point + (nodes[j].point - nodes[i].point) * t;
        cut.ends[found++] = {i, j};
      }
      if (found < 2) continue;
      cut.piece.length = (points[1] - points[0]).norm();
      planes[plane].push_back(cut);
    }
  }
  for (const auto& [plane, cuts] : planes) {
    std::map<End, std::vector<std::uint32_t>> at;
    for (std::uint32_t i = 0; i < cuts.size(); ++i) {
      for (const End& end : cuts[i].ends) at[end].push_back(i);
    }
    std::vector<bool> used(cuts.size(), false);
    const auto walk = [&](std::uint32_t start, int entry) {
      for (std::uint32_t i = start;;) {
        used[i] = true;
        Piece piece = cuts[i].piece;
        if (entry == 1) std::swap(piece.from, piece.to);
        pieces_.push_back(piece);
        const End exit = cuts[i].ends[1 - entry];
        const auto& there = at[exit];
        const auto next = std::find_if(there.begin(), there.end(), [&](std::uint32_t j) { return !used[j]; });
        if (next == there.end()) return;
        i = *next;
        entry = cuts[i].ends[0] < exit || exit < cuts[i].ends[0] ? 1 : 0;
      }
    };
    // Open lines from their ends, then what closes on itself.
    for (std::uint32_t i = 0; i < cuts.size(); ++i) {
      for (int k = 0; k < 2; ++k) {
        if (!used[i] && at[cuts[i].ends[k]].size() == 1) walk(i, k);
      }
    }
    for (std::uint32_t i = 0; i < cuts.size(); ++i) {
      if (!used[i]) walk(i, 0);
    }
  }
}

std::vector<SurfacePlace> ScanLines::places(double spacing, double phase) const {
  std::vector<SurfacePlace> result;
  double gone = 0, next = phase * spacing;
  std::uint64_t count = 0;
  for (const Piece& piece : pieces_) {
    const SamplingModel::Facet& facet = model_.facets()[piece.facet];
    for (; next < gone + piece.length; next = (double(++count) + phase) * spacing) {
      const Vec2 uv = piece.from + (piece.to - piece.from) * ((next - gone) / piece.length);
      if (model_.inside(facet, uv)) result.push_back({facet.face, uv});
    }
    gone += piece.length;
  }
  return result;
}

std::vector<SurfacePlace> grid_places(const SamplingModel& model, double spacing) {
  std::vector<SurfacePlace> result;
  std::vector<std::uint64_t> hits;
  for (std::size_t position = 0; position < model.faces().size(); ++position) {
    const SamplingModel::Face& face = model.faces()[position];
    const Vec2 extent = face.uv_max - face.uv_min;
    std::array<std::int64_t, 2> cells;
    Vec2 step;
    for (int k = 0; k < 2; ++k) {
      cells[k] = std::max<std::int64_t>(1, std::llround(extent[k] * face.scale[k] / spacing));
      step[k] = extent[k] / double(cells[k]);
    }
    hits.clear();
    for (std::uint32_t f = face.first_facet; f < face.first_facet + face.facet_count; ++f) {
      const SamplingModel::Facet& facet = model.facets()[f];
      std::array<Vec2, 3> c;  // corners, such that cell centres have whole coordinates
      for (int k = 0; k < 3; ++k) {
        const Vec2 d = model.nodes()[facet.nodes[k]].uv - face.uv_min;
        c[k] = {d[0] / step[0] - 0.5, d[1] / step[1] - 0.5};
      }
      const auto [low, high] = std::minmax({c[0][1], c[1][1], c[2][1]});
      for (auto j = std::max<std::int64_t>(0, std::llround(std::ceil(low))); j <= high && j < cells[1]; ++j) {
        double left = std::numeric_limits<double>::infinity(), right = -left;
        for (int k = 0; k < 3; ++k) {
          const Vec2 a = c[k], b = c[(k + 1) % 3];
          if (std::min(a[1], b[1]) > double(j) || std::max(a[1], b[1]) < double(j)) continue;
          for (const double t : a[1] == b[1] ? std::array{0.0, 1.0}
                                             : std::array{(j - a[1]) / (b[1] - a[1]), (j - a[1]) / (b[1] - a[1])}) {
            left = std::min(left, a[0] + (b[0] - a[0]) * t);
            right = std::max(right, a[0] + (b[0] - a[0]) * t);
          }
        }
        if (!(left <= right)) continue;
        for (auto i = std::max<std::int64_t>(0, std::llround(std::ceil(left))); i <= right && i < cells[0]; ++i) {
          const Vec2 uv(face.uv_min[0] + (double(i) + 0.5) * step[0], face.uv_min[1] + (double(j) + 0.5) * step[1]);
          if (model.inside(facet, uv)) hits.push_back(static_cast<std::uint64_t>(j) * cells[0] + i);
        }
      }
    }
    // A centre on the edge of two facets is found twice.
    std::sort(hits.begin(), hits.end());
    hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
    for (const std::uint64_t hit : hits) {
      const double i = double(hit % cells[0]), j = double(hit / cells[0]);
      result.push_back({static_cast<std::int32_t>(position),
                        {face.uv_min[0] + (i + 0.5) * step[0], face.uv_min[1] + (j + 0.5) * step[1]}});
    }
  }
  return result;
}

}  // namespace tri
