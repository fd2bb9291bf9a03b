#include "meshops/checks/mesh_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "meshops/crossings/surface_side.hpp"
#include "meshops/error.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/pace.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/closest_triangle.hpp"

namespace tri {
namespace {

using Hit = ClosestTriangle::Hit;

constexpr std::size_t samples_block = 1024;
constexpr std::uint64_t least_samples = 100'000;
constexpr std::uint64_t searches_per_cut = 7;  // the middles of three sides and of four quarters
constexpr double smallest_share = 1e-6;        // of the diagonal: differences below are not narrowed down further

// The greatest distance found so far. Equal ones keep the earlier, so blocks must be merged in order.
struct Farthest {
  double distance = -1;
  Vec3 place{0, 0, 0}, foot{0, 0, 0};

  void see(double d, const Vec3& p, const Vec3& q) {
    if (d > distance) distance = d, place = p, foot = q;
  }
  void see(const Farthest& other) { see(other.distance, other.place, other.foot); }
};

// A piece of a triangle of the first surface, with what is nearest to its corners.
struct Piece {
  std::array<Vec3, 3> corners;
  std::array<double, 3> distances;
  std::array<std::uint32_t, 3> nearest;
};

struct Bounded {
  Piece piece;
  double bound = 0;  // no place of the piece is farther away
};

// Bounds a piece from above, looking at its middle, too.
double bound_of(const Piece& piece, const ClosestTriangle& other, Farthest& farthest) {
  const Vec3 middle = (piece.corners[0] + piece.corners[1] + piece.corners[2]) / 3.0;
  const Hit hit = other.closest(middle, piece.nearest[0]);
  farthest.see(hit.distance, middle, hit.point);
  double bound = std::numeric_limits<double>::infinity(), reach = 0;
  for (int k = 0; k < 3; ++k) {
    const double a = (piece.corners[(k + 1) % 3] - piece.corners[k]).norm();
    const double b = (piece.corners[(k + 2) % 3] - piece.corners[k]).norm();
    bound = std::min(bound, piece.distances[k] + std::max(a, b));
    reach = std::max(reach, (piece.corners[k] - middle).norm());
  }
  bound = std::min(bound, hit.distance + reach);
  const std::array<std::uint32_t, 4> candidates{hit.triangle, piece.nearest[0], piece.nearest[1], piece.nearest[2]};
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (std::find(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(c), candidates[c]) !=
        candidates.begin() + static_cast<std::ptrdiff_t>(c))
      continue;
    double most = 0;
    for (const Vec3& p : piece.corners)
      most = std::max(most, (closest_on_triangle(other.corners(candidates[c]), p) - p).norm());
    bound = std::min(bound, most);
  }
  return bound;
}

class OneSided {
 public:
  OneSided(const Soup& first, const ClosestTriangle& second, const SurfaceSide& side, double diagonal,
           const MeshDistanceOptions& options, Context& context, const std::string& name)
      : mesh_(first), other_(second), side_(side), diagonal_(diagonal), options_(options), context_(context),
        name_(name) {}

  OneSidedDistance run() {
    visit_vertices();
    visit_samples();
    narrow();
    result_.max = farthest_.distance;
    result_.max_bound = std::max(result_.max_bound, result_.max);
    result_.place = farthest_.place;
    result_.foot = farthest_.foot;
    return std::move(result_);
  }

 private:
  template <class Body>
  void in_blocks(const std::string& step, std::size_t count, const Body& body) {
    std::vector<Farthest> farthest((count + samples_block - 1) / samples_block);
    for_each_block(
        context_, step.empty() ? "" : name_ + ": " + step, count, samples_block,
        [&](std::size_t block, std::size_t begin, std::size_t end) { body(block, begin, end, farthest[block]); });
    for (const Farthest& f : farthest) farthest_.see(f);
  }

  void visit_vertices() {
    Pace pace(context_);
    std::vector<bool> used(mesh_.points.size(), false);
    for (const Triangle& t : mesh_.triangles) {
      pace();
      for (const std::uint32_t v : t) used[v] = true;
    }
    result_.vertices.resize(mesh_.points.size());
    nearest_.resize(mesh_.points.size());
    in_blocks("vertices", mesh_.points.size(),
              [&](std::size_t, std::size_t begin, std::size_t end, Farthest& farthest) {
                std::uint32_t hint = 0;
                for (std::size_t i = begin; i < end; ++i) {
                  const Hit hit = other_.closest(mesh_.points[i], hint);
                  result_.vertices[i] = hit.distance * side_.side(mesh_.points[i], hit);
                  nearest_[i] = hint = hit.triangle;
                  if (used[i]) farthest.see(hit.distance, mesh_.points[i], hit.point);
                }
              });
  }

  void visit_samples() {
    Pace pace(context_);
    std::vector<double> until;  // area of the triangles up to and with this one
    until.reserve(mesh_.triangles.size());
    for (const Triangle& t : mesh_.triangles) {
      pace();
      const Vec3& a = mesh_.points[t[0]];
      result_.area += 0.5 * ((mesh_.points[t[1]] - a) % (mesh_.points[t[2]] - a)).norm();
      until.push_back(result_.area);
    }
    const std::uint64_t count = options_.samples.value_or(std::max<std::uint64_t>(mesh_.points.size(), least_samples));
    if (!(result_.area > 0) || count == 0) {
      mean_of_vertices();
      return;
    }
    result_.samples = count;
    std::vector<std::array<double, 2>> sums((count + samples_block - 1) / samples_block, {0, 0});
    in_blocks("samples", count, [&](std::size_t block, std::size_t begin, std::size_t end, Farthest& farthest) {
      for (std::size_t k = begin; k < end; ++k) {
        RandomStream random(options_.seed, k);
        const double place = (static_cast<double>(k) + random.uniform()) / static_cast<double>(count) * result_.area;
        auto index = static_cast<std::size_t>(std::upper_bound(until.begin(), until.end(), place) - until.begin());
        index = std::min(index, until.size() - 1);
        const Triangle& t = mesh_.triangles[index];
        const double side = std::sqrt(random.uniform()), along = random.uniform();
        const Vec3 p = mesh_.points[t[0]] * (1 - side) + mesh_.points[t[1]] * (side * (1 - along)) +
                       mesh_.points[t[2]] * (side * along);
        const Hit hit = other_.closest(p, nearest_[t[0]]);
        farthest.see(hit.distance, p, hit.point);
        sums[block][0] += hit.distance;
        sums[block][1] += hit.distance * hit.distance;
      }
    });
    double sum = 0, squares = 0;
    for (const auto& s : sums) sum += s[0], squares += s[1];
    const auto n = static_cast<double>(count);
    result_.mean = sum / n;
    result_.rms = std::sqrt(squares / n);
    // Of independent samples; stratified ones do better.
    result_.mean_error = std::sqrt(std::max(0.0, squares / n - result_.mean * result_.mean) / n);
  }

  void mean_of_vertices() {
    double sum = 0, squares = 0;
    for (const double d : result_.vertices) sum += std::abs(d), squares += d * d;
    const auto n = static_cast<double>(result_.vertices.size());
    result_.mean = sum / n;
    result_.rms = std::sqrt(squares / n);
  }

  // What may be left between the bounds.
  double wanted() const {
    return farthest_.distance + std::max(smallest_share * diagonal_, options_.relative_error * farthest_.distance);
  }

  void narrow() {
    Pace pace(context_);
    std::vector<Bounded> level = whole_triangles();
    std::uint64_t searches = level.size();
    for (;;) {
      const double limit = wanted();
      std::erase_if(level, [&](const Bounded& b) {
        pace();
        if (b.bound > limit) return false;
        result_.max_bound = std::max(result_.max_bound, b.bound);
        return true;
      });
      if (level.empty()) return;
      // The most promising pieces first, as many as may still be looked into.
      const std::uint64_t left = options_.max_searches > searches ? options_.max_searches - searches : 0;
      const std::uint64_t cuts = left / searches_per_cut;
      if (level.size() > cuts) {
        std::stable_sort(level.begin(), level.end(), [&](const Bounded& a, const Bounded& b) {
          pace();
          return a.bound > b.bound;
        });
        if (cuts == 0) {
          result_.max_bound = std::max(result_.max_bound, level.front().bound);
          return;
        }
        result_.max_bound = std::max(result_.max_bound, level[cuts].bound);
        level.resize(cuts);
      }
      searches += level.size() * searches_per_cut;
      level = quarters(level);
    }
  }

  std::vector<Bounded> whole_triangles() {
    std::vector<Bounded> level(mesh_.triangles.size());
    in_blocks("bounds", level.size(), [&](std::size_t, std::size_t begin, std::size_t end, Farthest& farthest) {
      for (std::size_t i = begin; i < end; ++i) {
        Piece& piece = level[i].piece;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = mesh_.triangles[i][k];
          piece.corners[k] = mesh_.points[v];
          piece.distances[k] = std::abs(result_.vertices[v]);
          piece.nearest[k] = nearest_[v];
        }
        level[i].bound = bound_of(piece, other_, farthest);
      }
    });
    return level;
  }

  std::vector<Bounded> quarters(const std::vector<Bounded>& level) {
    std::vector<Bounded> next(4 * level.size());
    in_blocks("", level.size(), [&](std::size_t, std::size_t begin, std::size_t end, Farthest& farthest) {
      for (std::size_t i = begin; i < end; ++i) {
        const Piece& whole = level[i].piece;
        Piece middle;  // corner k lies on the side opposite corner k of the whole
        for (std::size_t k = 0; k < 3; ++k) {
          middle.corners[k] = (whole.corners[(k + 1) % 3] + whole.corners[(k + 2) % 3]) / 2.0;
          const Hit hit = other_.closest(middle.corners[k], whole.nearest[(k + 1) % 3]);
          middle.distances[k] = hit.distance;
          middle.nearest[k] = hit.triangle;
          farthest.see(hit.distance, middle.corners[k], hit.point);
        }
        for (std::size_t k = 0; k < 4; ++k) {
          Piece& piece = next[4 * i + k].piece;
          piece = middle;
          if (k < 3) {
            piece.corners[k] = whole.corners[k];
            piece.distances[k] = whole.distances[k];
            piece.nearest[k] = whole.nearest[k];
          }
          next[4 * i + k].bound = std::min(level[i].bound, bound_of(piece, other_, farthest));
        }
      }
    });
    return next;
  }

  const Soup& mesh_;
  const ClosestTriangle& other_;
  const SurfaceSide& side_;
  const double diagonal_;
  const MeshDistanceOptions& options_;
  Context& context_;
  const std::string name_;
  OneSidedDistance result_;
  std::vector<std::uint32_t> nearest_;  // of every vertex
  Farthest farthest_;
};

double diagonal_of(const Soup& first, const Soup& second, Pace& pace) {
  Vec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const Soup* soup : {&first, &second})
    for (const Vec3& p : soup->points) {
      pace();
      low.minimize(p);
      high.maximize(p);
    }
  return (high - low).norm();
}

}  // namespace

MeshDistance mesh_distance(const Soup& first, const Soup& second, const MeshDistanceOptions& options,
                           Context& context) {
  if (!(options.relative_error > 0) || !std::isfinite(options.relative_error))
    throw InvalidInput("relative_error is " + std::to_string(options.relative_error) + "; it must be above 0");
  Pace pace(context);
  for (const Soup* soup : {&first, &second})
    for (std::size_t i = 0; i < soup->points.size(); ++i, pace())
      if (!std::isfinite(soup->points[i].norm()))
        throw InvalidInput("vertex " + std::to_string(i) + " has a coordinate that is not finite");
  const ClosestTriangle first_tree(first.points, first.triangles, &context);
  const ClosestTriangle second_tree(second.points, second.triangles, &context);
  const SurfaceSide first_side(first.points, first.triangles, &context);
  const SurfaceSide second_side(second.points, second.triangles, &context);
  const double diagonal = diagonal_of(first, second, pace);
  MeshDistance result;
  result.forward = OneSided(first, second_tree, second_side, diagonal, options, context, "first to second").run();
  result.backward = OneSided(second, first_tree, first_side, diagonal, options, context, "second to first").run();
  const OneSidedDistance &a = result.forward, &b = result.backward;
  result.hausdorff = std::max(a.max, b.max);
  result.hausdorff_bound = std::max(a.max_bound, b.max_bound);
  const double area = a.area + b.area, share = area > 0 ? a.area / area : 0.5;
  result.mean = share * a.mean + (1 - share) * b.mean;
  result.rms = std::sqrt(share * a.rms * a.rms + (1 - share) * b.rms * b.rms);
  return result;
}

}  // namespace tri
