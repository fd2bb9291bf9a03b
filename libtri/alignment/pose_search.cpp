#include "libtri/alignment/pose_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "libtri/alignment/point_pairs.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/random_stream.hpp"

namespace tri {
namespace {

constexpr std::size_t scan_pairs = 3000, poses_each = 32;
constexpr std::size_t field_cells = 400000;
constexpr double field_margin = 0.1;  // of the diagonal
// Rounds of scoring: points, poses that stay, kernel as a share of the diagonal.
struct SearchRound {
  std::size_t points, left;
  double kernel;
};
constexpr SearchRound rounds[] = {{24, 6000, 0.04}, {80, 1500, 0.04}, {250, 600, 0.03}};
constexpr double same_start = 0.03, same_found = 0.006;  // of the diagonal: poses nearer to each other are one
constexpr std::size_t most_starts = 240, most_jittered = 10, jitters = 8;
constexpr double jitter_shift = 0.015, jitter_turn = 0.06;  // of the diagonal; rad
constexpr double search_first_kernel = 0.05, jitter_kernel = 0.02, search_last_kernel = 0.004;
constexpr int search_first_steps = 16, jitter_steps = 12;
constexpr std::size_t anneal_points = 300, final_points = 1200;
constexpr double final_kernel = 0.005;
constexpr double unknown_normal = 0.6;  // counts a point whose normal is not known

using Vector6f = Eigen::Matrix<float, 6, 1>;
using Matrix6f = Eigen::Matrix<float, 6, 6>;

// From the scan about its centre to the model about the field's centre.
struct FastPose {
  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;
};

class Scorer {
 public:
  Scorer(const ScanSubset& scan, const SurfaceSamples& samples, const PoseSearchOptions& options)
      : field_(samples, field_margin * options.diagonal + options.probe_radius, field_cells),
        scan_centre_(to_eigen(scan.centre)), field_centre_(to_eigen(field_.centre())),
        diagonal_(static_cast<float>(options.diagonal)), probe_(static_cast<float>(options.probe_radius)),
        oriented_(scan.oriented) {
    // Points whose normals are known first, both parts in random order.
    std::vector<std::uint32_t> order(scan.points.size());
    std::iota(order.begin(), order.end(), 0u);
    RandomStream random(options.seed, 5);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
    for (const std::uint32_t i : order) {
      points_.push_back((to_eigen(scan.points[i]) - scan_centre_).cast<float>());
      normals_.push_back(to_eigen(scan.normals[i]).cast<float>());
    }
    // Farther than the samples lie apart a point is beside the surface, not over it.
    beside_ = 3 * static_cast<float>(field_.cell());
  }

  FastPose fast(const Pose& pose) const {
    return {pose.rotation.cast<float>(),
            (pose.rotation * scan_centre_ + pose.translation - field_centre_).cast<float>()};
  }
  Pose exact(const FastPose& fast) const {
    Pose pose;
    pose.rotation = Eigen::Quaterniond(fast.rotation.cast<double>()).normalized().toRotationMatrix();
    pose.translation = fast.translation.cast<double>() + field_centre_ - pose.rotation * scan_centre_;
    return pose;
  }

  double score(const FastPose& pose, int orientation, std::size_t count, float kernel) const {
    const float c2 = kernel * diagonal_ * kernel * diagonal_;
    float sum = 0;
    count = std::min(count, points_.size());
    for (std::size_t i = 0; i < count; ++i) {
      const Residual r = residual(pose, i, orientation);
      sum += r.weight * c2 / (c2 + r.value * r.value);
    }
    return sum / static_cast<float>(count);
  }

  // Gauss-Newton steps with weights of Geman & McClure; the kernel shrinks with every step.
  FastPose anneal(FastPose pose, int orientation, std::size_t count, double from, double to, int steps) const {
    count = std::min(count, points_.size());
    for (int step = 0; step < steps; ++step) {
      const double share = steps > 1 ? static_cast<double>(step) / (steps - 1) : 1;
      const auto kernel = static_cast<float>(from * std::pow(to / from, share));
      const float c2 = kernel * diagonal_ * kernel * diagonal_;
      Matrix6f a = Matrix6f::Zero();
      Vector6f b = Vector6f::Zero();
      for (std::size_t i = 0; i < count; ++i) {
        const Residual r = residual(pose, i, orientation);
        const float k = c2 / (c2 + r.value * r.value), w = r.weight * k * k;
        if (w < 1e-4f) continue;
        Vector6f j;
        const Eigen::Vector3f &x = r.at, &d = r.direction;
        j << (x[1] * d[2] - x[2] * d[1]) / diagonal_, (x[2] * d[0] - x[0] * d[2]) / diagonal_,
            (x[0] * d[1] - x[1] * d[0]) / diagonal_, d;
        a.selfadjointView<Eigen::Lower>().rankUpdate(j, w);
        b -= w * r.value * j;
      }
      const float damping = 1e-4f * a.diagonal().maxCoeff() + 1e-12f;
      a.diagonal().array() += damping;
      const Vector6f step_taken = a.selfadjointView<Eigen::Lower>().ldlt().solve(b);
      if (!step_taken.allFinite()) break;
      Eigen::Vector3f turn = step_taken.head<3>() / diagonal_, shift = step_taken.tail<3>();
      const float angle = turn.norm(), most = 0.3f;
      if (angle > most) turn *= most / angle;
      // The turn is about the field's centre, where `at` counts from.
      const Eigen::Matrix3f rotation = angle > 0 ? Eigen::AngleAxisf(turn.norm(), turn.normalized()).toRotationMatrix()
                                                 : Eigen::Matrix3f::Identity();
      pose.rotation = rotation * pose.rotation;
      pose.translation = rotation * pose.translation + shift;
    }
    pose.rotation = Eigen::Quaternionf(pose.rotation).normalized().toRotationMatrix();
    return pose;
  }

 private:
  struct Residual {
    float value;  // mm
    Eigen::Vector3f at, direction;
    float weight;
  };

  Residual residual(const FastPose& pose, std::size_t i, int orientation) const {
    Residual r;
    r.at = pose.rotation * points_[i] + pose.translation;
    const SampleField::Sample& s = field_.near(r.at.data());
    const Eigen::Map<const Eigen::Vector3f> point(s.point.data()), normal(s.normal.data());
    const Eigen::Vector3f d = r.at - point;
    const float along = d.dot(normal), distance2 = d.squaredNorm();
    const float reach = beside_ + std::abs(along);
    if (distance2 > reach * reach) {
      const float distance = std::sqrt(distance2);
      r.direction = d / distance;
      r.value = distance - probe_;
    } else {
      r.direction = normal;
      r.value = along - std::copysign(probe_, along);
    }
    const Eigen::Vector3f& n = normals_[i];
    if (n.squaredNorm() > 0.5f) {
      float c = (pose.rotation * n).dot(normal);
      c = oriented_ && orientation != 0 ? c * static_cast<float>(orientation) : std::abs(c);
      r.weight = c > 0.5f ? 2 * c - 1 : 0;
    } else {
      r.weight = static_cast<float>(unknown_normal);
    }
    return r;
  }

  SampleField field_;
  Eigen::Vector3d scan_centre_, field_centre_;
  std::vector<Eigen::Vector3f> points_, normals_;
  float diagonal_, probe_, beside_ = 0;
  bool oriented_;
};

// The best `left` by `score`, best first; equal scores keep their order.
template <class Item>
void keep_best(std::vector<Item>& items, std::size_t left) {
  std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.score > b.score; });
  if (items.size() > left) items.resize(left);
}

// Leaves the best of every group of poses within `reach`; `items` are best first.
void keep_different(std::vector<CoarsePose>& items, const ScanSubset& scan, double reach, std::size_t left) {
  std::vector<CoarsePose> kept;
  for (const CoarsePose& item : items) {
    if (kept.size() >= left) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const CoarsePose& k) {
      return k.orientation == item.orientation && pose_distance(k.pose, item.pose, scan.centre, scan.radius) < reach;
    });
    if (!known) kept.push_back(item);
  }
  items.swap(kept);
}

}  // namespace

double pose_distance(const Pose& a, const Pose& b, const Vec3& centre, double radius) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p =
        centre +
        Vec3(corner & 1 ? radius : -radius, corner & 2 ? radius : -radius, corner & 4 ? radius : -radius) * 0.57735;
    most = std::max(most, (a(p) - b(p)).sqrnorm());
  }
  return std::sqrt(most);
}

std::vector<CoarsePose> search_poses(const ScanSubset& scan, const SurfaceSamples& samples,
                                     std::span<const Pose> starts, const PoseSearchOptions& options,
                                     const Context& context) {
  context.progress("search pose", 0);
  const Scorer scorer(scan, samples, options);
  context.checkpoint();
  context.progress("search pose", 0.15);
  std::vector<CoarsePose> items;
  for (const PairPose& p : pair_poses(scan, samples, options.diagonal, scan_pairs, poses_each, options.seed, context))
    items.push_back({p.pose, p.orientation, 0});

  const auto for_each = [&](std::vector<CoarsePose>& list, const auto& body) {
    for_each_block(context, "", list.size(), 16, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(list[i]);
    });
  };
  double progress = 0.2;
  for (const SearchRound& round : rounds) {
    for_each(items, [&](CoarsePose& item) {
      item.score =
          scorer.score(scorer.fast(item.pose), item.orientation, round.points, static_cast<float>(round.kernel));
    });
    keep_best(items, round.left);
    context.progress("search pose", progress += 0.15);
  }
  keep_different(items, scan, same_start * options.diagonal, most_starts);
  for (const Pose& start : starts) {
    if (scan.oriented) {
      items.push_back({start, 1, 0});
      items.push_back({start, -1, 0});
    } else {
      items.push_back({start, 0, 0});
    }
  }

  const auto refine = [&](std::vector<CoarsePose>& list, double kernel, int steps) {
    for_each(list, [&](CoarsePose& item) {
      const FastPose pose =
          scorer.anneal(scorer.fast(item.pose), item.orientation, anneal_points, kernel, search_last_kernel, steps);
      item.pose = scorer.exact(pose);
      item.score = scorer.score(pose, item.orientation, final_points, static_cast<float>(final_kernel));
    });
    keep_best(list, list.size());
    keep_different(list, scan, same_found * options.diagonal, list.size());
  };
  refine(items, search_first_kernel, search_first_steps);
  context.progress("search pose", 0.85);

  std::vector<CoarsePose> copies;
  for (std::size_t i = 0; i < std::min(most_jittered, items.size()); ++i) {
    for (std::size_t k = 0; k < jitters; ++k) {
      RandomStream random(options.seed, 6, i * jitters + k);
      const Eigen::Vector3d turn = to_eigen(random.direction()) * (jitter_turn * random.uniform());
      const Eigen::Vector3d shift = to_eigen(random.direction()) * (jitter_shift * options.diagonal);
      CoarsePose copy = items[i];
      copy.pose = motion(turn, shift, to_eigen(items[i].pose(scan.centre))) * copy.pose;
      copies.push_back(copy);
    }
  }
  refine(copies, jitter_kernel, jitter_steps);
  items.insert(items.end(), copies.begin(), copies.end());
  keep_best(items, items.size());
  keep_different(items, scan, same_found * options.diagonal, options.count);
  context.progress("search pose", 1);
  return items;
}

}  // namespace tri
