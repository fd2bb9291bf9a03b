#include "libtri/sampling/virtual_measurement.hpp"

#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "libtri/model/triangle_tree.hpp"
#include "libtri/sampling/sampling_model.hpp"
#include "libtri/sampling/sampling_patterns.hpp"
#include "meshops/error.hpp"
#include "meshops/random_stream.hpp"

namespace tri {
namespace {

// What the random streams are for; the numbers are part of what a seed means.
enum Stream : std::uint64_t { places, drop_outs, lines, surplus, outlier_choice, outlier_place, noise, motion, order };

constexpr int max_tries = 200000;             // refusals in a row before nothing is left to measure
constexpr std::size_t least_refused = 20000;  // places of a regular pattern, all refused: nothing is left to measure
constexpr std::size_t points_block = 16384;   // points between two checkpoints
constexpr double outlier_low = 0.01, outlier_high = 0.1;  // of the diagonal

void validate(const MeasurementOptions& o) {
  const auto require = [](bool good, const char* name, double value, const char* allowed) {
    if (!good) throw InvalidInput(fmt::format("virtual measurement: {} is {}; allowed: {}", name, value, allowed));
  };
  require(o.points >= 1 && o.points <= 1'000'000'000, "points", double(o.points), "1 to 1e9");
  require(o.line_ratio >= 1 && o.line_ratio <= 1000, "line_ratio", o.line_ratio, "1 to 1000");
  require(o.noise >= 0 && std::isfinite(o.noise), "noise", o.noise, "0 or more mm");
  require(o.outliers >= 0 && o.outliers <= 1, "outliers", o.outliers, "a share in [0, 1]");
  require(o.drop_out_radius >= 0 && std::isfinite(o.drop_out_radius), "drop_out_radius", o.drop_out_radius,
          "0 or more mm");
  require(o.drop_outs >= 0, "drop_outs", o.drop_outs, "0 or more");
  require(o.max_angle > 0 && o.max_angle <= std::numbers::pi / 2, "max_angle", o.max_angle,
          "above 0, at most pi/2 rad");
  for (const Vec3& view : o.views) {
    require(view.sqrnorm() > 0 && std::isfinite(view.sqrnorm()), "the length of a view", view.norm(),
            "above 0, finite");
  }
  for (const Vec3& centre : o.drop_out_centres) {
    require(std::isfinite(centre.sqrnorm()), "a drop-out centre's distance", centre.norm(), "finite");
  }
}

class Measurement {
 public:
  Measurement(const Shape& shape, const MeasurementOptions& options, Context& context)
      : options_(options), context_(context),
        arena_(context.threads > 0 ? std::min(context.threads, tbb::info::default_concurrency())
                                   : tbb::task_arena::automatic),
        model_(shape, context) {
    for (Vec3 view : options.views) views_.push_back(view.normalize());
    if (!views_.empty() || options.outliers > 0) build_tree();
    result_.unusable_faces = model_.unusable_faces();
  }

  VirtualMeasurement run() {
    draw_drop_outs();
    if (options_.pattern == SamplingPattern::random) {
      take_random();
    } else {
      take_regular();
    }
    spoil();
    move();
    if (options_.shuffle) shuffle();
    return std::move(result_);
  }

 private:
  RandomStream stream(Stream stream, std::uint64_t index = 0) const {
    return RandomStream(options_.seed, stream, index);
  }

  AreaSampler& area_sampler() {
    if (!area_sampler_) area_sampler_.emplace(model_, context_);
    return *area_sampler_;
  }

  void build_tree() {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
    for (const auto& node : model_.nodes()) points.push_back(node.point);
    for (const auto& facet : model_.facets()) triangles.push_back(facet.nodes);
    tree_.emplace(points, triangles);
  }

  // body(first, last) over blocks of [0, count), in parallel, with a checkpoint between rounds.
  template <class Body>
  void in_blocks(std::size_t count, const char* step, const Body& body) {
    constexpr std::size_t round = 16 * points_block;
    for (std::size_t begin = 0; begin < count; begin += round) {
      context_.progress(step, double(begin) / double(count));
      const std::size_t end = std::min(count, begin + round);
      arena_.execute([&] {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, points_block / 16), [&](const auto& range) {
          if (!context_.cancelled()) body(range.begin(), range.end());
        });
      });
      context_.checkpoint();
    }
    context_.progress(step, 1);
  }

  bool visible(const SamplingModel::Sample& sample) const {
    if (views_.empty()) return true;
    const double least = std::cos(options_.max_angle);
    for (const Vec3& view : views_) {
      if ((sample.normal | view) < least) continue;
      // Start above the facets, which may lie above the surface.
      if (!tree_->hit(sample.point + sample.normal * (2 * model_.deflection()), view)) return true;
    }
    return false;
  }

  bool measured(const SamplingModel::Sample& sample) const {
    for (const Vec3& centre : result_.drop_out_centres) {
      if ((sample.point - centre).sqrnorm() < options_.drop_out_radius * options_.drop_out_radius) return false;
    }
    return visible(sample);
  }

  [[noreturn]] static void nothing_left() {
    throw InvalidInput("virtual measurement: the views and drop-outs leave nothing of the model to measure");
  }

  void draw_drop_outs() {
    for (int i = 0; i < options_.drop_outs; ++i) {
      RandomStream random = stream(drop_outs, i);
      SurfacePlace place;
      SamplingModel::Sample sample;
      if (!area_sampler().draw(
              random, [this](const auto& s) { return visible(s); }, max_tries, place, sample))
        nothing_left();
      drawn_.push_back(sample.point);
    }
    result_.drop_out_centres = drawn_;
    result_.drop_out_centres.insert(result_.drop_out_centres.end(), options_.drop_out_centres.begin(),
                                    options_.drop_out_centres.end());
  }

  TruePoint truth(const SurfacePlace& place, const SamplingModel::Sample& sample) const {
    return {model_.faces()[place.face].index, false, place.uv, sample.point, sample.normal};
  }

  void take_random() {
    AreaSampler& sampler = area_sampler();
    // One place first: if nothing can be measured, this fails once and not for every point.
    result_.truth.resize(1);
    std::atomic<bool> failed = false;
    std::atomic<std::uint64_t> tries = 0;
    const auto take = [&](std::size_t first, std::size_t last) {
      std::uint64_t asked = 0;
      const auto accept = [&](const SamplingModel::Sample& s) {
        ++asked;
        return measured(s);
      };
      for (std::size_t i = first; i < last && !failed; ++i) {
        RandomStream random = stream(places, i);
        SurfacePlace place;
        SamplingModel::Sample sample;
        if (!sampler.draw(random, accept, max_tries, place, sample)) {
          failed = true;
          return;
        }
        result_.truth[i] = truth(place, sample);
      }
      tries += asked;
    };
    take(0, 1);
    if (failed) nothing_left();
    tries = 0;
    result_.truth.resize(options_.points);
    in_blocks(options_.points, "sample", take);
    if (failed) nothing_left();
    const double share = double(options_.points) / double(tries);
    result_.spacing = std::sqrt(sampler.area() * share / double(options_.points));
  }

  // The places that can be measured, in their order.
  std::vector<TruePoint> evaluate(const std::vector<SurfacePlace>& wanted) {
    std::vector<TruePoint> all(wanted.size());
    in_blocks(wanted.size(), "sample", [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const SamplingModel::Sample sample = model_.sample(wanted[i].face, wanted[i].uv);
        all[i] = measured(sample) ? truth(wanted[i], sample) : TruePoint{};
      }
    });
    std::erase_if(all, [](const TruePoint& t) { return t.face == 0; });
    return all;
  }

  // Scan or grid: the widest spacing found that gives enough points, less a few at random.
  void take_regular() {
    const auto wanted = double(options_.points);
    const bool scan = options_.pattern == SamplingPattern::scan;
    double spacing = std::sqrt(area_sampler().area() / wanted);
    std::optional<ScanLines> all_lines;
    if (scan) {
      // The length of all lines is inverse to their distance, nearly: solve distance = ratio * spacing = ratio * length
      // / points.
      double distance = std::sqrt(options_.line_ratio * area_sampler().area() / wanted);
      double share = 1;
      for (int i = 0; i < 3; ++i) {
        all_lines.emplace(make_lines(distance));
        if (all_lines->length() <= 0) nothing_left();
        if (i == 2) break;
        if (i == 0 && (!views_.empty() || !result_.drop_out_centres.empty())) {
          constexpr double probes = least_refused;
          share = double(evaluate(all_lines->places(all_lines->length() / probes, 0.5)).size()) / probes;
          if (share == 0) nothing_left();
        }
        distance *= std::sqrt(options_.line_ratio * share * all_lines->length() / wanted / distance);
      }
      spacing = share * all_lines->length() / wanted;
      result_.line_spacing = all_lines->distance();
    }
    const double phase = stream(lines, 1).uniform();
    std::vector<TruePoint> best;
    double previous = 0;
    for (int i = 0; i < 24; ++i) {
      const std::vector<SurfacePlace> wide = scan ? all_lines->places(spacing, phase) : grid_places(model_, spacing);
      std::vector<TruePoint> found = evaluate(wide);
      const auto count = double(found.size());
      if (found.empty() && wide.size() > least_refused) nothing_left();
      if (count >= wanted && (best.empty() || found.size() < best.size())) {
        best = std::move(found);
        result_.spacing = spacing;
      }
      if (!best.empty() && double(best.size()) <= 1.01 * wanted + 1) break;
      if (!best.empty() && count == previous) break;  // a grid cannot have fewer points than faces
      previous = count;
      const double ratio = std::max(count, 0.01 * wanted) / wanted;
      spacing *= (scan ? ratio : std::sqrt(ratio)) * (i < 1 ? 1 - 1e-9 : i < 8 ? 0.998 : 0.99);
    }
    if (best.empty()) nothing_left();
    // Leave out the surplus, keeping the order [Knuth, selection sampling].
    RandomStream random = stream(surplus);
    std::uint64_t needed = options_.points, left = best.size();
    for (const TruePoint& t : best) {
      if (random.below(left--) < needed) {
        result_.truth.push_back(t);
        --needed;
      }
    }
  }

  ScanLines make_lines(double distance) {
    Vec3 low = model_.nodes()[0].point, high = low;
    for (const auto& node : model_.nodes()) {
      low.minimize(node.point);
      high.maximize(node.point);
    }
    const Vec3 extent = high - low;
    int axis[3] = {0, 1, 2};
    std::stable_sort(axis, axis + 3, [&](int a, int b) { return extent[a] > extent[b]; });
    // Turned a little, so that no plane lies in a face of the model nor runs along an edge.
    RandomStream random = stream(lines);
    Vec3 travel(0, 0, 0), second(0, 0, 0);
    travel[axis[0]] = second[axis[1]] = 1;
    travel[axis[1]] = random.uniform(0.05, 0.15);
    travel[axis[2]] = random.uniform(0.05, 0.15);
    second[axis[2]] = random.uniform(0.05, 0.15);
    return ScanLines(model_, travel.normalize(), second.normalize(), distance, random);
  }

  // Noise and outliers: from the truth to the measured points.
  void spoil() {
    const std::size_t count = result_.truth.size();
    RandomStream choice = stream(outlier_choice);
    auto needed = static_cast<std::uint64_t>(std::llround(options_.outliers * double(count)));
    for (std::uint64_t i = 0, left = count; i < count && needed > 0; ++i) {
      if (choice.below(left--) < needed) {
        result_.truth[i].outlier = true;
        --needed;
      }
    }
    result_.points.resize(count);
    std::atomic<bool> failed = false;
    in_blocks(count, "noise", [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const TruePoint& t = result_.truth[i];
        result_.points[i] = t.point;
        if (t.outlier) {
          if (!place_outlier(i)) failed = true;
        } else if (options_.noise > 0) {
          RandomStream random = stream(noise, i);
          result_.points[i] += t.normal * (options_.noise * random.normal());
        }
      }
    });
    if (failed) throw InvalidInput("virtual measurement: found no place for an outlier away from the model");
  }

  bool place_outlier(std::size_t i) {
    RandomStream random = stream(outlier_place, i);
    const double diagonal = model_.diagonal();
    // Far from every face, not only from its own.
    for (int k = 0; k < 10000; ++k) {
      const Vec3 direction = random.direction();
      const double distance = random.uniform(outlier_low, outlier_high) * diagonal;
      result_.points[i] = result_.truth[i].point + direction * distance;
      if (!tree_->nearer_than(result_.points[i], outlier_low * diagonal + model_.deflection())) return true;
    }
    return false;
  }

  void move() {
    auto& m = result_.to_model;
    for (int k = 0; k < 4; ++k) m[k][k] = 1;
    if (!options_.move) return;
    // A uniform rotation from a uniform unit quaternion; its transpose, and the way back, make the matrix.
    RandomStream random = stream(motion);
    double q[4], norm = 0;
    for (double& x : q) {
      x = random.normal();
      norm += x * x;
    }
    for (double& x : q) x /= std::sqrt(norm);
    const auto [w, x, y, z] = q;
    const double rotation[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                                   {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                                   {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
    Vec3 shift;
    for (int k = 0; k < 3; ++k) shift[k] = random.uniform(-1, 1) * model_.diagonal();
    for (Vec3& p : result_.points) {
      const Vec3 old = p;
      for (int k = 0; k < 3; ++k)
        p[k] = rotation[k][0] * old[0] + rotation[k][1] * old[1] + rotation[k][2] * old[2] + shift[k];
    }
    for (int r = 0; r < 3; ++r) {
      m[r][3] = 0;
      for (int c = 0; c < 3; ++c) {
        m[r][c] = rotation[c][r];
        m[r][3] -= rotation[c][r] * shift[c];
      }
    }
  }

  void shuffle() {
    RandomStream random = stream(order);
    for (std::uint64_t i = result_.points.size(); i > 1; --i) {
      const std::uint64_t j = random.below(i);
      std::swap(result_.points[i - 1], result_.points[j]);
      std::swap(result_.truth[i - 1], result_.truth[j]);
    }
  }

  const MeasurementOptions& options_;
  Context& context_;
  tbb::task_arena arena_;
  SamplingModel model_;
  std::vector<Vec3> views_;
  std::vector<Vec3> drawn_;
  std::optional<AreaSampler> area_sampler_;
  std::optional<TriangleTree> tree_;
  VirtualMeasurement result_;
};

}  // namespace

SamplingPattern sampling_pattern(std::string_view name) {
  if (name == "random") return SamplingPattern::random;
  if (name == "scan") return SamplingPattern::scan;
  if (name == "grid") return SamplingPattern::grid;
  throw InvalidInput(fmt::format("no sampling pattern is called '{}'; known: random, scan, grid", name));
}

VirtualMeasurement measure(const Shape& shape, const MeasurementOptions& options, Context& context) {
  validate(options);
  return Measurement(shape, options, context).run();
}

}  // namespace tri
