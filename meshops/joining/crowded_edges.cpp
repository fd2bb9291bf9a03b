#include "meshops/joining/crowded_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "meshops/pace.hpp"

namespace tri {
namespace {

using Side = std::int32_t;
constexpr Side unpaired = SidePairs::none;
constexpr std::uint32_t unset = 0xffffffff;

/// One side of a crowded edge, in angular order.
struct Spoke {
  double angle = 0;
  Side side = unpaired;
  bool along = false;  ///< runs from the lower to the higher point
  std::uint32_t shell = 0;
  std::size_t partner = static_cast<std::size_t>(-1);  ///< place in the order

  bool paired() const { return partner != static_cast<std::size_t>(-1); }
};
using Spokes = std::vector<Spoke>;

/// Which shells are turned relative to each other: union-find with parities.
class Turns {
 public:
  Turns(std::size_t shells, bool allowed) : allowed_(allowed), parent_(shells), odd_(shells, 0) {
    for (std::size_t i = 0; i < shells; ++i) parent_[i] = i;
  }
  /// The shell that stands for its set, and whether `i` is turned relative to it.
  std::pair<std::size_t, bool> find(std::size_t i) {
    std::size_t root = i;
    bool odd = false;
    for (; parent_[root] != root; root = parent_[root]) odd ^= odd_[root] != 0;
    for (bool rest = odd; parent_[i] != i;) {  // shortens the way for the next time
      const bool step = odd_[i] != 0;
      odd_[i] = rest;
      rest ^= step;
      i = std::exchange(parent_[i], root);
    }
    return {root, odd};
  }
  /// False if the shells are tied the other way already.
  bool tie(std::size_t a, std::size_t b, bool odd) {
    if (!allowed_) return !odd;
    const auto [root_a, odd_a] = find(a);
    const auto [root_b, odd_b] = find(b);
    if (root_a == root_b) return (odd_a != odd_b) == odd;
    const bool turn = (odd_a != odd_b) != odd;
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    odd_[std::max(root_a, root_b)] = turn;
    return true;
  }

 private:
  bool allowed_;
  std::vector<std::size_t> parent_;
  std::vector<char> odd_;
};

class CrowdPairing {
 public:
  CrowdPairing(std::span<const Triangle> triangles, std::span<const Vec3> points, SidePairs& pairs, bool may_turn,
               const Context& context)
      : triangles_(triangles), points_(points), pairs_(pairs), pace_(context, 4096), turns_(number_shells(), may_turn) {
  }

  std::vector<std::uint32_t> run() {
    std::vector<Spokes> all;
    for (const auto& crowd : pairs_.crowded) {
      pace_();
      Spokes spokes = in_order(crowd);
      pair(spokes);
      all.push_back(std::move(spokes));
    }
    // Of shells tied together the smaller part is turned.
    std::vector<std::size_t> kept(shells_, 0), turned(shells_, 0);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      pace_();
      const auto [root, odd] = turns_.find(shell_[t]);
      ++(odd ? turned : kept)[root];
    }
    std::vector<std::uint32_t> reverse;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      pace_();
      const auto [root, odd] = turns_.find(shell_[t]);
      if (turned[root] > 0 && odd == (turned[root] <= kept[root])) reverse.push_back(t);
    }
    if (!reverse.empty()) return reverse;
    for (const Spokes& spokes : all)
      for (const Spoke& s : spokes)
        if (s.paired()) pairs_.twin[s.side] = spokes[s.partner].side;
    return reverse;
  }

 private:
  std::uint32_t from(Side side) const { return triangles_[static_cast<std::size_t>(side / 3)][side % 3]; }

  std::size_t number_shells() {
    shell_.assign(triangles_.size(), unset);
    std::vector<std::uint32_t> queue;
    for (std::uint32_t seed = 0; seed < triangles_.size(); ++seed) {
      if (shell_[seed] != unset) continue;
      shell_[seed] = static_cast<std::uint32_t>(shells_);
      queue.assign(1, seed);
      for (std::size_t i = 0; i < queue.size(); ++i) {
        pace_();
        for (Side side = static_cast<Side>(3 * queue[i]); side < static_cast<Side>(3 * queue[i] + 3); ++side) {
          const Side other = pairs_.twin[side];
          if (other == unpaired || shell_[static_cast<std::size_t>(other / 3)] != unset) continue;
          shell_[static_cast<std::size_t>(other / 3)] = static_cast<std::uint32_t>(shells_);
          queue.push_back(static_cast<std::uint32_t>(other / 3));
        }
      }
      ++shells_;
    }
    return shells_;
  }

  Spokes in_order(const std::vector<Side>& sides) const {
    const std::uint32_t a = from(sides[0]), b = from(SidePairs::next(sides[0])), u = std::min(a, b), v = std::max(a, b);
    const Vec3 axis = points_[v] - points_[u];
    std::vector<Vec3> arms;
    for (const Side side : sides) {
      const Vec3 arm = points_[from(SidePairs::previous(side))] - points_[u];
      arms.push_back(arm * axis.sqrnorm() - axis * (arm | axis));
    }
    const Vec3 x = *std::ranges::max_element(arms, {}, [](const Vec3& arm) { return arm.sqrnorm(); });
    const Vec3 y = axis % x;
    const double y_scale = x.norm() / std::max(y.norm(), std::numeric_limits<double>::min());
    Spokes spokes;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      double angle = std::atan2((arms[i] | y) * y_scale, arms[i] | x);
      // A coordinate that is not finite gives no angle; the order of the list then stands in.
      if (!std::isfinite(angle)) angle = 0;
      spokes.push_back({angle, sides[i], from(sides[i]) == u, shell_[static_cast<std::size_t>(sides[i] / 3)]});
    }
    std::ranges::sort(spokes, {}, [](const Spoke& s) { return std::pair(s.angle, s.side); });
    return spokes;
  }

  void pair(Spokes& spokes) {
    std::vector<std::size_t> rest, every;
    int balance = 0;
    for (std::size_t i = 0; i < spokes.size(); ++i) {
      every.push_back(i);
      if (std::ranges::count(spokes, spokes[i].shell, &Spoke::shell) == 1) continue;
      rest.push_back(i);
      balance += spokes[i].along ? 1 : -1;
    }
    const auto along = std::ranges::count(spokes, true, &Spoke::along);
    if (2 * along == static_cast<std::ptrdiff_t>(spokes.size()))
      enclose(spokes, every);
    else if (balance == 0)
      enclose(spokes, rest);
    smooth(spokes);
  }

  /// Pairs around material, as parentheses are paired.
  void enclose(Spokes& spokes, const std::vector<std::size_t>& places) {
    std::vector<std::size_t> open;
    for (int round = 0; round < 2; ++round) {
      for (const std::size_t i : places) {
        if (spokes[i].paired()) continue;
        if (!spokes[i].along) {
          if (round == 0) open.push_back(i);
        } else if (!open.empty()) {
          if (turns_.tie(spokes[i].shell, spokes[open.back()].shell, false)) join(spokes, i, open.back());
          open.pop_back();
        }
      }
    }
  }

  void smooth(Spokes& spokes) {
    std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
    for (std::size_t i = 0; i < spokes.size(); ++i)
      for (std::size_t j = i + 1; j < spokes.size(); ++j)
        if (!spokes[i].paired() && !spokes[j].paired())
          candidates.emplace_back(std::abs(spokes[j].angle - spokes[i].angle - std::numbers::pi), i, j);
    std::sort(candidates.begin(), candidates.end());
    neighbors(spokes);
    for (const auto& [bend, i, j] : candidates) {
      if (spokes[i].paired() || spokes[j].paired() || crosses(spokes, i, j)) continue;
      if (turns_.tie(spokes[i].shell, spokes[j].shell, spokes[i].along == spokes[j].along)) join(spokes, i, j);
    }
  }

  /// Of an even number each with the next one, so that none is left over: in that one of the two ways in which more of
  /// them run against each other, or else the smoother.
  void neighbors(Spokes& spokes) {
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < spokes.size(); ++i)
      if (!spokes[i].paired()) left.push_back(i);
    const std::size_t n = left.size();
    if (n < 4 || n % 2 != 0) return;
    std::array<std::pair<int, double>, 2> worth{};  // same ways, bends
    for (std::size_t k = 0; k < n; ++k) {
      const Spoke &a = spokes[left[k]], &b = spokes[left[(k + 1) % n]];
      worth[k % 2].first += a.along == b.along;
      worth[k % 2].second += std::abs(std::abs(b.angle - a.angle) - std::numbers::pi);
    }
    for (std::size_t k = worth[1] < worth[0] ? 1 : 0; k < n; k += 2) {
      const std::size_t i = left[k], j = left[(k + 1) % n];
      if (crosses(spokes, std::min(i, j), std::max(i, j))) continue;
      if (turns_.tie(spokes[i].shell, spokes[j].shell, spokes[i].along == spokes[j].along)) join(spokes, i, j);
    }
  }

  static bool crosses(const Spokes& spokes, std::size_t i, std::size_t j) {
    for (std::size_t k = i + 1; k < j; ++k)
      if (spokes[k].paired() && (spokes[k].partner < i || spokes[k].partner > j)) return true;
    return false;
  }

  static void join(Spokes& spokes, std::size_t i, std::size_t j) {
    spokes[i].partner = j;
    spokes[j].partner = i;
  }

  std::span<const Triangle> triangles_;
  std::span<const Vec3> points_;
  SidePairs& pairs_;
  Pace pace_;
  std::vector<std::uint32_t> shell_;
  std::size_t shells_ = 0;
  Turns turns_;
};

}  // namespace

std::vector<std::uint32_t> pair_crowded_sides(std::span<const Triangle> triangles, std::span<const Vec3> points,
                                              SidePairs& pairs, bool may_turn, const Context& context) {
  return CrowdPairing(triangles, points, pairs, may_turn, context).run();
}

}  // namespace tri
