#include "libtri/alignment/point_pairs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "meshops/for_each_block.hpp"
#include "meshops/random_stream.hpp"

namespace tri {
namespace {

constexpr std::size_t model_places = 1500;
constexpr std::size_t model_pairs = 400000;
constexpr double shortest_model_pair = 0.05;  // of the diagonal
constexpr double shortest_scan_pair = 0.35;   // of the scan's radius
constexpr int distance_bins = 40;
constexpr double distance_step = 0.03;  // of the diagonal
// Bins of 15 degrees whose middles are at 0, 90 and 180, where most angles of most parts lie.
constexpr int angle_bins = 13;
constexpr std::uint32_t keys = distance_bins * angle_bins * angle_bins * angle_bins;

struct Placed {
  Eigen::Vector3d point, normal;
};

int angle_bin(double cosine) {
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  return static_cast<int>(std::lround(angle * (angle_bins - 1) / std::numbers::pi));
}

// `keys` where the pair is longer than any of the model.
std::uint32_t key_of(const Placed& a, const Placed& b, double diagonal) {
  const Eigen::Vector3d d = b.point - a.point;
  const double length = d.norm();
  const int bin = static_cast<int>(length / (distance_step * diagonal));
  if (bin >= distance_bins || !(length > 0)) return keys;
  int key = bin;
  key = key * angle_bins + angle_bin(a.normal.dot(d) / length);
  key = key * angle_bins + angle_bin(b.normal.dot(d) / length);
  key = key * angle_bins + angle_bin(a.normal.dot(b.normal));
  return static_cast<std::uint32_t>(key);
}

// The motion that takes the line a1 a2 onto b1 b2, middle on middle, and turns the normals onto each other as well as a
// turn about the line can. False where the normals lie along the line and say nothing.
bool pose_of_pairs(const Placed& a1, const Placed& a2, const Placed& b1, const Placed& b2, Pose& pose) {
  const Eigen::Vector3d from = (a2.point - a1.point).normalized(), to = (b2.point - b1.point).normalized();
  const Eigen::Matrix3d first = Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
  double sine = 0, cosine = 0;
  const std::array<std::pair<const Placed*, const Placed*>, 2> both{{{&a1, &b1}, {&a2, &b2}}};
  for (const auto& [a, b] : both) {
    const Eigen::Vector3d n = first * a->normal, u = n - to * to.dot(n), m = b->normal - to * to.dot(b->normal);
    sine += to.dot(u.cross(m));
    cosine += u.dot(m);
  }
  if (sine * sine + cosine * cosine < 0.01) return false;
  pose.rotation = Eigen::AngleAxisd(std::atan2(sine, cosine), to).toRotationMatrix() * first;
  pose.translation = 0.5 * (b1.point + b2.point) - pose.rotation * (0.5 * (a1.point + a2.point));
  return true;
}

// Pairs of samples in the order of their keys.
struct PairTable {
  PairTable(const SurfaceSamples& samples, double diagonal, std::uint64_t seed) {
    for (const std::uint32_t i : random_indices(samples.points.size(), model_places, seed))
      places.push_back({to_eigen(samples.points[i]), to_eigen(samples.normals[i])});
    std::vector<std::array<std::uint32_t, 3>> found;  // key, first, second
    found.reserve(model_pairs);
    RandomStream random(seed, 3);
    for (std::size_t i = 0; i < model_pairs && places.size() > 1; ++i) {
      const auto a = static_cast<std::uint32_t>(random.below(places.size()));
      const auto b = static_cast<std::uint32_t>(random.below(places.size()));
      if ((places[a].point - places[b].point).norm() < shortest_model_pair * diagonal) continue;
      const std::uint32_t key = key_of(places[a], places[b], diagonal);
      if (key < keys) found.push_back({key, a, b});
    }
    start.assign(keys + 1, 0);
    for (const auto& f : found) ++start[f[0] + 1];
    for (std::uint32_t k = 0; k < keys; ++k) start[k + 1] += start[k];
    pairs.resize(found.size());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (const auto& f : found) pairs[next[f[0]]++] = {f[1], f[2]};
  }

  std::vector<Placed> places;
  std::vector<std::uint32_t> start;
  std::vector<std::array<std::uint32_t, 2>> pairs;
};

}  // namespace

std::vector<PairPose> pair_poses(const ScanSubset& scan, const SurfaceSamples& samples, double diagonal,
                                 std::size_t pairs, std::size_t each, std::uint64_t seed, const Context& context) {
  std::vector<Placed> places;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (scan.normals[i].sqrnorm() > 0.5) places.push_back({to_eigen(scan.points[i]), to_eigen(scan.normals[i])});
  if (places.size() < 2) return {};
  const PairTable table(samples, diagonal, seed);
  context.checkpoint();

  std::vector<std::vector<PairPose>> found(pairs);
  const auto look_up = [&](std::size_t i) {
    RandomStream random(seed, 4, i);
    Placed a, b;
    int tries = 20;
    do {
      a = places[random.below(places.size())];
      b = places[random.below(places.size())];
    } while (--tries > 0 && (a.point - b.point).norm() < shortest_scan_pair * scan.radius);
    if (tries == 0) return;
    // The lists of samples for each combination of signs.
    struct List {
      std::uint32_t begin, end;
      double sign_a, sign_b;
    };
    std::array<List, 4> lists;
    std::size_t count = 0, total = 0;
    for (const double sign_a : {1.0, -1.0}) {
      for (const double sign_b : {1.0, -1.0}) {
        if (scan.oriented && sign_a != sign_b) continue;
        const std::uint32_t key = key_of({a.point, sign_a * a.normal}, {b.point, sign_b * b.normal}, diagonal);
        if (key == keys) continue;
        lists[count] = {table.start[key], table.start[key + 1], sign_a, sign_b};
        total += lists[count].end - lists[count].begin;
        ++count;
      }
    }
    const std::size_t wanted = std::min(total, each);
    for (std::size_t k = 0; k < wanted; ++k) {
      std::size_t at = wanted == total ? k : random.below(total), l = 0;
      while (at >= lists[l].end - lists[l].begin) at -= lists[l].end - lists[l].begin, ++l;
      const auto& pair = table.pairs[lists[l].begin + at];
      PairPose candidate;
      candidate.orientation = scan.oriented ? (lists[l].sign_a > 0 ? 1 : -1) : 0;
      if (pose_of_pairs({a.point, lists[l].sign_a * a.normal}, {b.point, lists[l].sign_b * b.normal},
                        table.places[pair[0]], table.places[pair[1]], candidate.pose))
        found[i].push_back(candidate);
    }
  };
  for_each_block(context, "", pairs, 32, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) look_up(i);
  });
  std::vector<PairPose> all;
  for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace tri
