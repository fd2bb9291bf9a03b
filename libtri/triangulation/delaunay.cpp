#include "libtri/triangulation/delaunay.hpp"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "libtri/surfaces/page_buffer.hpp"
#include "libtri/triangulation/spatial_order.hpp"
#include "meshops/crossings/predicates.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

using Index = std::uint32_t;
constexpr Index none = 0xffffffff;
constexpr std::size_t serial_points = 1 << 14;  // fixed, so that the result does not depend on the number of threads
constexpr std::size_t emit_block = 1 << 16;

// Directed edges e and e^1 are one edge both ways. In the ring of edges out of one origin, `next` is counter-clockwise.
struct Ring {
  Index next, previous;
};

// What a finished range of points hands to the merge above it: one counter-clockwise edge of its hull (the outer face
// lies to the right), or the point itself if there is only one.
struct Part {
  Index handle = none;
  Index count = 0;
};

// Edge slots of a range of m points: 3m, never exceeded because a planar graph has fewer edges. Freed slots are used
// again first, so that memory stays warm.
class EdgePool {
 public:
  EdgePool(Index first_edge, Index end_edge) : fresh_{{first_edge, end_edge}} {}

  // Returns the first of two directed edges.
  Index take(Ring* rings) {
    if (free_head_ != none) {
      const Index e = free_head_;
      free_head_ = rings[e].next;
      if (free_head_ == none) free_tail_ = none;
      return e;
    }
    while (fresh_.back().first == fresh_.back().second) fresh_.pop_back();
    return 2 * fresh_.back().first++;
  }
  void give(Index e, Ring* rings) {
    rings[e].next = free_head_;
    if (free_head_ == none) free_tail_ = e;
    free_head_ = e;
  }
  void join(EdgePool& other, Ring* rings) {
    if (other.free_head_ != none) {
      rings[other.free_tail_].next = free_head_;
      if (free_head_ == none) free_tail_ = other.free_tail_;
      free_head_ = other.free_head_;
    }
    fresh_.insert(fresh_.end(), other.fresh_.begin(), other.fresh_.end());
  }
  template <class Visit>
  void for_unused(Ring* rings, Visit visit) const {
    for (Index e = free_head_, following; e != none; e = following) {
      following = rings[e].next;
      visit(e);
    }
    for (const auto& [first, end] : fresh_)
      for (Index edge = first; edge < end; ++edge) visit(2 * edge);
  }

 private:
  Index free_head_ = none, free_tail_ = none;
  std::vector<std::pair<Index, Index>> fresh_;
};

class Builder {
 public:
  Builder(std::span<const Vec2> points, std::span<const std::uint16_t> cuts, const PlanePredicates& test,
          const Context& context)
      : points_(points.data()), cuts_(cuts), test_(test), context_(context),
        rings_(PageBuffer<Ring>(6 * points.size())), origin_(PageBuffer<Index>(6 * points.size())) {}

  // Triangulates all points; returns a hull edge whose right face is the outer one. Unused slots become
  // loose edges, which are in no triangle.
  Index run() {
    const auto n = static_cast<Index>(cuts_.size());
    EdgePool pool(0, 0);
    const Part whole = build(0, n, pool);
    pool.for_unused(rings_.get(), [&](Index e) {
      origin_[e] = origin_[e ^ 1] = 0;
      rings_[e] = {e, e};
      rings_[e ^ 1] = {e ^ 1, e ^ 1};
    });
    return whole.handle;
  }

  PageBuffer<Ring>& rings() { return rings_; }
  PageBuffer<Index>& origins() { return origin_; }

 private:
  Index origin(Index e) const { return origin_[e]; }
  Index target(Index e) const { return origin_[e ^ 1]; }
  Index next(Index e) const { return rings_[e].next; }
  Index previous(Index e) const { return rings_[e].previous; }
  const Vec2& at(Index v) const { return points_[v]; }
  int turn(Index a, Index b, Index c) const { return test_.orientation(at(a), at(b), at(c)); }

  Index make_edge(Index from, Index to, EdgePool& pool) {
    const Index e = pool.take(rings_.get());
    origin_[e] = from;
    origin_[e ^ 1] = to;
    rings_[e] = {e, e};
    rings_[e ^ 1] = {e ^ 1, e ^ 1};
    return e;
  }
  // Of a loose edge and a point to its left. Returns the edge.
  Index make_triangle(Index e, Index corner, EdgePool& pool) {
    const Index f = make_edge(target(e), corner, pool), g = make_edge(corner, origin(e), pool);
    const auto pair = [&](Index a, Index b) {
      rings_[a] = {b, b};
      rings_[b] = {a, a};
    };
    pair(e ^ 1, f);
    pair(f ^ 1, g);
    pair(g ^ 1, e);
    return e;
  }
  void insert_after(Index place, Index e) {
    const Index after = rings_[place].next;
    rings_[place].next = e;
    rings_[e] = {after, place};
    rings_[after].previous = e;
  }
  void unlink(Index e) {
    const Ring ring = rings_[e];
    rings_[ring.previous].next = ring.next;
    rings_[ring.next].previous = ring.previous;
  }
  void remove_edge(Index e, EdgePool& pool) {
    unlink(e);
    unlink(e ^ 1);
    pool.give(e & ~Index{1}, rings_.get());
  }

  Part build(Index begin, Index end, EdgePool& pool) {
    if (end - begin <= serial_points) {
      context_.checkpoint();
      pool = EdgePool(3 * begin, 3 * end);
      return build_serial(begin, end, pool);
    }
    const auto cut = std::min_element(cuts_.begin() + begin + 1, cuts_.begin() + end);
    const auto middle = static_cast<Index>(cut - cuts_.begin());
    EdgePool right_pool(0, 0);
    Part left, right;
    tbb::parallel_invoke([&] { left = build(begin, middle, pool); }, [&] { right = build(middle, end, right_pool); });
    pool.join(right_pool, rings_.get());
    return merge(left, right, *cut & 1, pool);
  }

  // The tree of cuts from its leaves up: whenever a cut is earlier than the last one, what lies before it is complete.
  Part build_serial(Index begin, Index end, EdgePool& pool) {
    struct Pending {
      Part part;
      int cut;  // before the part
    };
    std::vector<Pending> stack;
    stack.reserve(80);
    const auto merge_top = [&] {
      const Pending right = stack.back();
      stack.pop_back();
      stack.back().part = merge(stack.back().part, right.part, right.cut & 1, pool);
    };
    stack.push_back({{begin, 1}, -1});
    for (Index i = begin + 1; i < end; ++i) {
      const int cut = cuts_[i];
      while (stack.back().cut > cut) merge_top();
      stack.push_back({{i, 1}, cut});
    }
    while (stack.size() > 1) merge_top();
    return stack.back().part;
  }

  // The edge of the counter-clockwise hull whose origin comes last in `before`, a strict order by a direction. Since
  // the hull is convex, climbing from anywhere ends at the top.
  template <class Before>
  Index climb(Index e, Before before) const {
    Index v = origin(e);
    Index ahead = next(e ^ 1), w = origin(ahead);
    if (before(at(v), at(w))) {
      do {
        e = ahead;
        v = w;
        ahead = next(e ^ 1);
        w = origin(ahead);
      } while (before(at(v), at(w)));
      return e;
    }
    Index behind = previous(e) ^ 1;
    w = origin(behind);
    while (before(at(v), at(w))) {
      e = behind;
      v = w;
      behind = previous(e) ^ 1;
      w = origin(behind);
    }
    return e;
  }
  Index last_along(int axis, Index e) const {
    return climb(e, [axis](const Vec2& p, const Vec2& q) {
      return p[axis] != q[axis] ? p[axis] < q[axis] : p[1 - axis] < q[1 - axis];
    });
  }
  Index first_along(int axis, Index e) const {
    return climb(e, [axis](const Vec2& p, const Vec2& q) {
      return p[axis] != q[axis] ? p[axis] > q[axis] : p[1 - axis] > q[1 - axis];
    });
  }

  // The cut by y is the cut by x seen after a quarter turn: `left` is what has the smaller coordinate.
  Part merge(const Part& left, const Part& right, int axis, EdgePool& pool) {
    const Index count = left.count + right.count;
    if (count == 2) return {make_edge(left.handle, right.handle, pool), 2};

    if (count == 3) {
      const Index corner = left.count == 1 ? left.handle : right.handle;
      const Index side = left.count == 1 ? right.handle : left.handle;
      const int side_turn = turn(origin(side), target(side), corner);
      if (side_turn != 0) return {make_triangle(side_turn > 0 ? side : side ^ 1, corner, pool), 3};
    }

    // Lower common tangent. `l` is the clockwise hull edge out of the left end, `r` the counter-clockwise one out of
    // the right end.
    Index l = none, r = none, left_point = left.handle, right_point = right.handle;
    if (left.count > 1) {
      l = previous(last_along(axis, left.handle));
      left_point = origin(l);
    }
    if (right.count > 1) {
      r = first_along(axis, right.handle);
      right_point = origin(r);
    }
    for (;;) {
      if (l != none && turn(left_point, target(l), right_point) > 0) {
        l = previous(l ^ 1);
        left_point = origin(l);
      } else if (r != none && turn(right_point, left_point, target(r)) > 0) {
        r = next(r ^ 1);
        right_point = origin(r);
      } else {
        break;
      }
    }
    Index base = make_edge(right_point, left_point, pool);
    if (r != none) insert_after(previous(r), base);
    if (l != none) insert_after(l, base ^ 1);
    const Index lowest = base;

    // Zip upwards: the next edge goes to whichever candidate has no point of the other side inside its circle.
    for (;;) {
      left_point = target(base);
      right_point = origin(base);
      Index lc = next(base ^ 1), rc = previous(base);
      Index lp = target(lc), rp = target(rc);
      const bool left_up = lp != right_point && turn(lp, left_point, right_point) > 0;
      const bool right_up = rp != left_point && turn(rp, left_point, right_point) > 0;
      if (left_up) {
        for (;;) {
          const Index behind = next(lc), p = target(behind);
          if (p == right_point || test_.in_circle(at(left_point), at(right_point), at(lp), at(p)) <= 0) break;
          remove_edge(lc, pool);
          lc = behind;
          lp = p;
        }
      }
      if (right_up) {
        for (;;) {
          const Index behind = previous(rc), p = target(behind);
          if (p == left_point || test_.in_circle(at(left_point), at(right_point), at(rp), at(p)) <= 0) break;
          remove_edge(rc, pool);
          rc = behind;
          rp = p;
        }
      }
      if (!left_up && !right_up) break;
      if (!left_up || (right_up && test_.in_circle(at(lp), at(left_point), at(right_point), at(rp)) > 0)) {
        const Index e = make_edge(rp, left_point, pool);
        insert_after(previous(rc ^ 1), e);
        insert_after(base ^ 1, e ^ 1);
        base = e;
      } else {
        const Index e = make_edge(right_point, lp, pool);
        insert_after(previous(base), e);
        insert_after(lc ^ 1, e ^ 1);
        base = e;
      }
    }
    return {lowest ^ 1, count};
  }

  const Vec2* points_;
  std::span<const std::uint16_t> cuts_;
  const PlanePredicates& test_;
  const Context& context_;
  PageBuffer<Ring> rings_;
  PageBuffer<Index> origin_;
};

// Reads the triangles off the rings: the cycles of three to the left of their edges, each found at its lowest edge.
class Emitter {
 public:
  Emitter(PageBuffer<Ring>& rings, PageBuffer<Index>& origins, std::size_t n_slots)
      : rings_(rings), origins_(origins), n_slots_(n_slots), blocks_((n_slots + emit_block - 1) / emit_block),
        lowest_((n_slots + 63) / 64, 0) {}

  void run(Index hull_edge, Delaunay& result) {
    std::vector<std::size_t> first(blocks_ + 1, 0);
    tbb::parallel_for(std::size_t{0}, blocks_, [&](std::size_t block) {
      const std::size_t end = std::min(lowest_.size(), (block + 1) * (emit_block / 64));
      for (std::size_t word = block * (emit_block / 64); word < end; ++word) {
        std::uint64_t bits = 0;
        const auto slots = static_cast<Index>(std::min<std::size_t>(64, n_slots_ - 64 * word));
        for (Index k = 0; k < slots; ++k) {
          // Without branches: two of three edges are not the lowest, in no order that could be predicted.
          const Index a = static_cast<Index>(64 * word) + k;
          const Index b = after(a), c = after(b);
          const bool found = (a < b) & (a < c);
          bits |= std::uint64_t{found} << k;
        }
        lowest_[word] = bits;
      }
    });
    // Every face but the outer one is a triangle.
    const Index outer_edge = hull_edge ^ 1;
    Index e = outer_edge;
    do {
      lowest_[e / 64] &= ~(std::uint64_t{1} << e % 64);
      e = after(e);
    } while (e != outer_edge);
    for (std::size_t word = 0; word < lowest_.size(); ++word)
      first[word / (emit_block / 64) + 1] += static_cast<std::size_t>(std::popcount(lowest_[word]));
    for (std::size_t block = 0; block < blocks_; ++block) first[block + 1] += first[block];

    // `next` is not needed any more: it becomes the triangle to the left.
    result.triangles.resize(first[blocks_]);
    do {
      rings_[e].next = none;
      e = after(e);
    } while (e != outer_edge);
    for_triangles(first, [&](std::size_t t, Index a, Index b, Index c) {
      result.triangles[t] = {origins_[a], origins_[b], origins_[c]};
      rings_[a].next = rings_[b].next = rings_[c].next = static_cast<Index>(t);
    });
    origins_.reset();
    result.neighbors.resize(first[blocks_]);
    for_triangles(first, [&](std::size_t t, Index a, Index b, Index c) {
      result.neighbors[t] = {across(b), across(c), across(a)};
    });
  }

 private:
  Index after(Index e) const { return rings_[e ^ 1].previous; }  // along the face to the left
  std::int32_t across(Index e) const { return static_cast<std::int32_t>(rings_[e ^ 1].next); }

  template <class Visit>
  void for_triangles(const std::vector<std::size_t>& first, Visit visit) {
    tbb::parallel_for(std::size_t{0}, blocks_, [&](std::size_t block) {
      std::size_t t = first[block];
      const std::size_t end = std::min(lowest_.size(), (block + 1) * (emit_block / 64));
      for (std::size_t word = block * (emit_block / 64); word < end; ++word) {
        for (std::uint64_t bits = lowest_[word]; bits != 0; bits &= bits - 1) {
          const Index a = static_cast<Index>(64 * word) + static_cast<Index>(std::countr_zero(bits));
          const Index b = after(a);
          visit(t++, a, b, after(b));
        }
      }
    });
  }

  PageBuffer<Ring>& rings_;
  PageBuffer<Index>& origins_;
  std::size_t n_slots_, blocks_;
  std::vector<std::uint64_t> lowest_;  // one bit per directed edge: the lowest of a triangle
};

// A power of two that brings every coordinate into the range where rounding-error bounds hold, without losing a bit; 0
// if there is none.
int safe_shift(const BitRange& range) {
  if (range.safe()) return 0;
  const int shift = 250 - range.top;
  return BitRange{range.lowest + shift, range.top + shift}.safe() ? shift : 0;
}

void triangulate(std::span<const Vec2> input, const Context& context, Delaunay& result) {
  BitRange range = bit_range(input);
  const int shift = safe_shift(range);
  range.lowest += shift;
  range.top += shift;
  const PlanePredicates test(range);

  SpatialOrder sorted = spatial_order(input, context);
  result.duplicates = std::move(sorted.duplicates);
  const std::size_t n = sorted.order.size();
  if (n < 3) return;
  auto points = PageBuffer<Vec2>(n);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, emit_block), [&](const auto& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      const Vec2& p = input[sorted.order[i]];
      points[i] = shift == 0 ? p : Vec2(std::ldexp(p[0], shift), std::ldexp(p[1], shift));
    }
  });
  context.progress("delaunay", 0.2);
  context.checkpoint();

  Builder builder({points.get(), n}, sorted.cuts, test, context);
  const Index hull_edge = builder.run();
  points.reset();
  std::vector<std::uint16_t>().swap(sorted.cuts);
  context.progress("delaunay", 0.8);
  context.checkpoint();

  auto& origins = builder.origins();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, 6 * n, emit_block), [&](const auto& part) {
    for (std::size_t e = part.begin(); e < part.end(); ++e) origins[e] = sorted.order[origins[e]];
  });
  std::vector<std::uint32_t>().swap(sorted.order);
  context.checkpoint();
  Emitter(builder.rings(), origins, 6 * n).run(hull_edge, result);
}

}  // namespace

Delaunay delaunay(std::span<const Vec2> points, Context& context) {
  if (points.size() >= std::size_t{1} << 29) throw InvalidInput("delaunay: more than 2^29 points");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::isfinite(points[i][0]) || !std::isfinite(points[i][1]))
      throw InvalidInput(fmt::format("delaunay: point {} is not finite: ({}, {})", i, points[i][0], points[i][1]));
  context.checkpoint();
  context.progress("delaunay", 0);
  Delaunay result;
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] { triangulate(points, context, result); });
  context.progress("delaunay", 1);
  return result;
}

}  // namespace tri
