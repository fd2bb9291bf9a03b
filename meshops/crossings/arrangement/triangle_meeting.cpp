#include "meshops/crossings/arrangement/triangle_meeting.hpp"

#include <algorithm>

namespace tri {
namespace {

constexpr int next(int k) {
  return k == 2 ? 0 : k + 1;
}
constexpr TrianglePlace nowhere = -1;

/// The place whose side tests gave these signs (all of one kind, or zero).
TrianglePlace place_of(const std::array<int, 3>& signs) {
  int positive = 0, negative = 0, zeros = 0, zero = 0;
  for (int k = 0; k < 3; ++k) {
    positive += signs[k] > 0, negative += signs[k] < 0;
    if (signs[k] == 0) zero = k, ++zeros;
  }
  if (positive > 0 && negative > 0) return nowhere;
  if (zeros == 0) return in_interior;
  if (zeros == 1) return 3 + zero;
  return signs[0] == 0 && signs[2] == 0 ? 0 : zero;  // between sides zero - 1 and zero
}

/// Where a point of its plane lies on a triangle.
TrianglePlace locate(const GridTriangle& t, const GridPoint& p, int axis) {
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  std::array<int, 3> signs;
  for (int k = 0; k < 3; ++k) signs[k] = turn(t[k], t[next(k)], p, i, j);
  return place_of(signs);
}

bool on_one_side(TrianglePlace a, TrianglePlace b) {
  const auto on = [](TrianglePlace p, int k) { return p == 3 + k || p == k || p == next(k); };
  for (int k = 0; k < 3; ++k)
    if (on(a, k) && on(b, k)) return true;
  return false;
}

class Meeter {
 public:
  Meeter(const GridTriangle& a, const Triangle& ia, const GridTriangle& b, const Triangle& ib, TriangleMeeting& out)
      : t_{&a, &b}, id_{&ia, &ib}, out_(out) {}

  void run() {
    for (int s = 0; s < 2; ++s) {
      const GridTriangle &mine = *t_[s], &theirs = *t_[1 - s];
      int positive = 0, negative = 0;
      for (int k = 0; k < 3; ++k) {
        side_[s][k] = shared(s, k) ? 0 : sign_of(volume6(theirs[0], theirs[1], theirs[2], mine[k]));
        positive += side_[s][k] > 0, negative += side_[s][k] < 0;
      }
      if (positive == 3 || negative == 3) return;
      if (positive == 0 && negative == 0) return in_one_plane();
      axis_[s] = longest_axis(normal_of(mine[0], mine[1], mine[2]));
    }
    across();
  }

 private:
  bool shared(int s, int corner) const {
    for (const std::uint32_t v : *id_[1 - s])
      if (v == (*id_[s])[corner]) return true;
    return false;
  }

  /// @param mine place on triangle s, @param theirs on the other
  int add(int s, TrianglePlace mine, TrianglePlace theirs, const ExactPoint& point) {
    const TrianglePlace first = s == 0 ? mine : theirs, second = s == 0 ? theirs : mine;
    for (std::size_t i = 0; i < out_.points.size(); ++i)
      if (out_.points[i].on_first == first && out_.points[i].on_second == second) return static_cast<int>(i);
    out_.points.push_back({first, second, point});
    return static_cast<int>(out_.points.size()) - 1;
  }

  void across() {
    for (int s = 0; s < 2; ++s) {
      const GridTriangle &mine = *t_[s], &theirs = *t_[1 - s];
      for (int k = 0; k < 3; ++k) {
        if (side_[s][k] == 0) {
          const TrianglePlace place = locate(theirs, mine[k], axis_[1 - s]);
          if (place != nowhere) add(s, k, place, exact(mine[k]));
        }
        if (side_[s][k] * side_[s][next(k)] >= 0) continue;
        std::array<int, 3> signs;
        for (int e = 0; e < 3; ++e) signs[e] = sign_of(volume6(mine[k], mine[next(k)], theirs[e], theirs[next(e)]));
        const TrianglePlace place = place_of(signs);
        if (place == nowhere) continue;
        add(s, 3 + k, place, place < 3 ? exact(theirs[place]) : where_crosses(mine[k], mine[next(k)], theirs));
      }
    }
    if (out_.points.size() == 2) {
      const CommonPoint &p = out_.points[0], &q = out_.points[1];
      if (!on_one_side(p.on_first, q.on_first)) out_.segments.push_back({0, 1, plane_through(*t_[1]), true});
      if (!on_one_side(p.on_second, q.on_second)) out_.segments.push_back({0, 1, plane_through(*t_[0]), false});
    }
    drop_idle();
  }

  void in_one_plane() {
    const GridTriangle& a = *t_[0];
    const int axis = longest_axis(normal_of(a[0], a[1], a[2]));
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    for (int s = 0; s < 2; ++s) {
      const GridTriangle &mine = *t_[s], &theirs = *t_[1 - s];
      for (int k = 0; k < 3; ++k) {
        // What side k of mine has in common with the other triangle.
        const GridPoint &p = mine[k], &q = mine[next(k)];
        std::vector<int> found;
        for (const int corner : {k, next(k)}) {
          const TrianglePlace place = locate(theirs, mine[corner], axis);
          if (place != nowhere) found.push_back(add(s, corner, place, exact(mine[corner])));
        }
        std::array<int, 3> at;
        for (int e = 0; e < 3; ++e) at[e] = turn(p, q, theirs[e], i, j);
        for (int e = 0; e < 3; ++e) {
          if (at[e] == 0 && locate(mine, theirs[e], axis) == 3 + k) found.push_back(add(s, 3 + k, e, exact(theirs[e])));
          if (at[e] * at[next(e)] >= 0) continue;
          const GridPoint &u = theirs[e], &v = theirs[next(e)];
          if (turn(u, v, p, i, j) * turn(u, v, q, i, j) < 0)
            found.push_back(add(s, 3 + k, 3 + e, where_meet(p, q, u, v, axis)));
        }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        if (found.size() < 2) continue;
        // A side meets a triangle in at most two points of its rim, its own ends inside it included.
        const auto place = [&](int f) { return s == 0 ? out_.points[f].on_second : out_.points[f].on_first; };
        if (on_one_side(place(found.front()), place(found.back()))) continue;
        out_.segments.push_back({found.front(), found.back(), plane_along_axis(p, q, axis), s == 1});
      }
    }
    drop_idle();
  }

  /// Corners that the triangles share, and so no cut, are left out unless a segment ends there.
  void drop_idle() {
    if (!out_.segments.empty()) return;
    std::erase_if(out_.points, [](const CommonPoint& p) { return p.on_first < 3 && p.on_second < 3; });
  }

  std::array<const GridTriangle*, 2> t_;
  std::array<const Triangle*, 2> id_;
  TriangleMeeting& out_;
  int side_[2][3];
  int axis_[2];
};

}  // namespace

void meet(const GridTriangle& first, const Triangle& first_ids, const GridTriangle& second, const Triangle& second_ids,
          TriangleMeeting& meeting) {
  meeting.clear();
  Meeter(first, first_ids, second, second_ids, meeting).run();
}

}  // namespace tri
