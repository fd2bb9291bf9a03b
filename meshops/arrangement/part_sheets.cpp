#include "meshops/arrangement/part_sheets.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "meshops/arrangement/triangle_meeting.hpp"
#include "meshops/overlap_tree.hpp"

namespace tri {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
constexpr int halvings = 8;

Vec3 vector_of(const GridPoint& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

struct Raised {
  std::uint32_t apex;             ///< vertex
  std::uint32_t first;            ///< of its three triangles
  Vec3 base, direction;           ///< unit
  double height;                  ///< grid steps
};

class Parter {
 public:
  Parter(const CrossingComplex& complex, const SolidBoundary& boundary, double height)
      : c_(complex), b_(boundary), height_(height) {}

  PlacedBoundary run(Context& context) {
    for (const auto& [p, q] : b_.vertex) {
      GridPoint at;
      for (int k = 0; k < 3; ++k) at[k] = (c_.points[p][k] + c_.points[q][k]) / 2;
      out_.points.push_back(at);
      out_.point.push_back(p == q ? p : none);
    }
    for (std::size_t t = 0; t < b_.triangles.size(); ++t) {
      if (b_.sheet[t] == 0) {
        out_.triangles.push_back(b_.triangles[t]);
        out_.face.push_back(b_.face[t]);
      } else {
        raise(t);
      }
    }
    out_.parted = raised_.size();
    settle(context);
    return std::move(out_);
  }

 private:
  void raise(std::size_t t) {
    const Triangle& v = b_.triangles[t];
    const Vec3 a = vector_of(out_.points[v[0]]), b = vector_of(out_.points[v[1]]), c = vector_of(out_.points[v[2]]);
    const Vec3 n = (b - a) % (c - a);
    const double la = (b - c).norm(), lb = (c - a).norm(), lc = (a - b).norm();
    const double twice_area = n.norm();
    const double inradius = twice_area / (la + lb + lc);
    Raised r;
    r.apex = static_cast<std::uint32_t>(out_.points.size());
    r.first = static_cast<std::uint32_t>(out_.triangles.size());
    r.base = (a * la + b * lb + c * lc) / (la + lb + lc);
    r.direction = n * (b_.sheet[t] / twice_area);
    r.height = std::max(1.0, std::min(height_, 0.1 * inradius));
    out_.points.push_back({});
    out_.point.push_back(none);
    place(r);
    for (int k = 0; k < 3; ++k) {
      owner_.resize(out_.triangles.size() + 1, none);
      owner_.back() = static_cast<std::uint32_t>(raised_.size());
      out_.triangles.push_back({v[k], v[(k + 1) % 3], r.apex});
      out_.face.push_back(b_.face[t]);
    }
    raised_.push_back(r);
  }

  void place(const Raised& r) {
    const Vec3 p = r.base + r.direction * r.height;
    for (int k = 0; k < 3; ++k) out_.points[r.apex][k] = static_cast<std::int64_t>(std::floor(p[k] + 0.5));
  }

  GridTriangle corners(std::uint32_t t) const {
    const Triangle& v = out_.triangles[t];
    return {out_.points[v[0]], out_.points[v[1]], out_.points[v[2]]};
  }

  /// Halves the height of what crosses until nothing does.
  void settle(Context& context) {
    if (raised_.empty()) return;
    owner_.resize(out_.triangles.size(), none);
    // Numbers by place: copies of a vertex touch, which is no crossing.
    std::vector<std::uint32_t> place_id(out_.points.size());
    std::map<GridPoint, std::uint32_t> seen;
    for (std::uint32_t i = 0; i < out_.points.size(); ++i)
      place_id[i] = out_.point[i] != none ? out_.point[i] : i + static_cast<std::uint32_t>(c_.points.size());
    for (std::uint32_t i = 0; i < b_.vertex.size(); ++i)
      if (out_.point[i] == none)
        place_id[i] = seen.emplace(out_.points[i], place_id[i]).first->second;
    std::vector<OverlapTree::Box> boxes(out_.triangles.size());
    std::vector<std::uint32_t> items(out_.triangles.size());
    const auto box_of = [&](std::uint32_t t) {
      OverlapTree::Box box;
      for (const GridPoint& p : corners(t)) box.grow(vector_of(p));
      return box;
    };
    for (std::uint32_t t = 0; t < items.size(); ++t) items[t] = t, boxes[t] = box_of(t);
    const OverlapTree tree(boxes, items);  // heights only shrink, but roundings may leave a box by a step
    std::vector<char> active(raised_.size(), 1);
    TriangleMeeting meeting;
    for (int round = 0; round <= halvings; ++round) {
      context.checkpoint();
      std::vector<char> bad(raised_.size(), 0);
      bool any = false;
      for (std::uint32_t r = 0; r < raised_.size(); ++r) {
        if (!active[r]) continue;
        for (std::uint32_t t = raised_[r].first; t < raised_[r].first + 3; ++t) {
          const GridTriangle mine = corners(t);
          const Triangle my = ids(t, place_id);
          OverlapTree::Box box = box_of(t);
          box.lo -= Vec3(1, 1, 1), box.hi += Vec3(1, 1, 1);
          if (normal_of(mine[0], mine[1], mine[2]) == GridPoint{}) bad[r] = 1;
          tree.overlapping(box, 0, [&](std::uint32_t u) {
            if (u == t) return;
            const GridTriangle theirs = corners(u);
            if (normal_of(theirs[0], theirs[1], theirs[2]) == GridPoint{}) return;
            const Triangle their = ids(u, place_id);
            meet(mine, my, theirs, their, meeting);
            if (!meeting.cuts() && !falls_together(mine, my, theirs, their)) return;
            bad[r] = 1;
            if (owner_[u] != none) bad[owner_[u]] = 1;
          });
        }
        any |= bad[r] != 0;
      }
      if (!any) return;
      if (round == halvings) {
        for (std::uint32_t r = 0; r < raised_.size(); ++r)
          if (bad[r]) out_.touching.push_back(out_.face[raised_[r].first]);
        return;
      }
      std::fill(active.begin(), active.end(), 0);
      for (std::uint32_t r = 0; r < raised_.size(); ++r) {
        if (!bad[r]) continue;
        active[r] = 1;
        raised_[r].height *= 0.5;
        place(raised_[r]);
      }
    }
  }

  /// Whether corners of different numbers have the same place, which `meet` does not expect.
  static bool falls_together(const GridTriangle& a, const Triangle& ia, const GridTriangle& b, const Triangle& ib) {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (ia[i] != ib[j] && a[i] == b[j]) return true;
    return false;
  }

  Triangle ids(std::uint32_t t, const std::vector<std::uint32_t>& place_id) const {
    const Triangle& v = out_.triangles[t];
    return {place_id[v[0]], place_id[v[1]], place_id[v[2]]};
  }

  const CrossingComplex& c_;
  const SolidBoundary& b_;
  const double height_;
  PlacedBoundary out_;
  std::vector<Raised> raised_;
  std::vector<std::uint32_t> owner_;
};

}  // namespace

PlacedBoundary part_sheets(const CrossingComplex& complex, const SolidBoundary& boundary, double height, Context& context) {
  return Parter(complex, boundary, height).run(context);
}

}  // namespace tri
