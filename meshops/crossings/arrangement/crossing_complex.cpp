#include "meshops/crossings/arrangement/crossing_complex.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>

#include "meshops/crossings/arrangement/face_triangulation.hpp"
#include "meshops/crossings/arrangement/grid_hash.hpp"
#include "meshops/crossings/arrangement/triangle_meeting.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/cancellable_sort.hpp"
#include "meshops/search/number_map.hpp"
#include "meshops/search/overlap_tree.hpp"

namespace tri {
namespace {

using Face = CrossingComplex::Face;
using EdgeKey = std::uint64_t;

constexpr std::size_t max_rounds = 20;
constexpr std::size_t exact_rounds = 1;  ///< before what is near is taken to touch
constexpr std::size_t reach_doublings = 7;
constexpr int tidy_passes = 4;
constexpr std::uint32_t long_steps = 1024;  ///< of some microseconds, between two looks for a cancel
constexpr std::size_t pairs_to_grow = 500;  ///< more than twice as many as at first, and these: the cuts make it worse

EdgeKey edge_key_of(std::uint32_t a, std::uint32_t b) {
  return static_cast<EdgeKey>(std::min(a, b)) << 32 | std::max(a, b);
}

class CrossingResolver {
 public:
  CrossingResolver(CrossingComplex& complex, double first_reach, double most_reach, Context& context)
      : c_(complex), first_reach_(first_reach), most_reach_(most_reach), context_(context), pace_(context),
        number_(complex.points.size()) {}

  CrossingReport run() {
    for (std::uint32_t i = 0; i < c_.points.size(); ++i) pace_(), number_.insert(c_.points[i], i);
    fresh_.assign(c_.faces.size(), 1);
    unite();
    CrossingReport report;
    const std::size_t most_faces = 50000 + 20 * c_.faces.size();
    for (std::size_t round = 0; round < max_rounds; ++round) {
      context_.checkpoint();
      reach_ =
          round < exact_rounds
              ? 0
              : std::min(most_reach_,
                         std::ldexp(first_reach_, static_cast<int>(std::min(round - exact_rounds, reach_doublings))));
      find();
      if (round == 0) report.pairs = pairs_;
      report.left = pairs_;
      if (pairs_ == 0 || c_.faces.size() > most_faces || pairs_ > 2 * report.pairs + pairs_to_grow) break;
      if (reach_ > 0) {
        tidy();
        find();
        report.left = pairs_;
        if (pairs_ == 0) break;
      }
      ++report.rounds;
      report.reach = reach_;
      report.cut += cut(false);
      unite();
    }
    return report;
  }

 private:
  struct EdgePoint {
    EdgeKey edge;
    std::uint32_t point;
  };
  struct FacePoint {
    std::uint32_t face, point;
  };
  struct Segment {
    std::uint32_t face, from, to;
    GridPlane plane;
  };

  GridTriangle corners(const Face& f) const { return {c_.points[f.v[0]], c_.points[f.v[1]], c_.points[f.v[2]]}; }

  static constexpr std::uint32_t by_place = 0xffffffffu;

  /// @param vertex what the point becomes, if not the vertex at its rounded place
  std::uint32_t keep(const ExactPoint& p, std::uint32_t vertex = by_place) {
    pool_.push_back(p);
    becomes_.push_back(vertex);
    return static_cast<std::uint32_t>(pool_.size()) - 1;
  }

  OverlapTree::Box box_of(const Face& face) const {
    OverlapTree::Box box;
    for (const GridPoint& p : corners(face))
      box.grow(Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])));
    return box;
  }

  /// Fills the lists of cuts from every pair with a fresh face.
  void find() {
    forget_cuts();
    involved_.clear();
    pairs_ = 0;
    std::vector<OverlapTree::Box> boxes(c_.faces.size());
    OverlapTree::Box all;
    std::vector<std::uint32_t> items;
    for (std::uint32_t f = 0; f < c_.faces.size(); ++f) {
      pace_();
      const GridTriangle t = corners(c_.faces[f]);
      boxes[f] = box_of(c_.faces[f]);
      if (fresh_[f]) all.grow(boxes[f]);
      if (fresh_[f] && normal_of(t[0], t[1], t[2]) == GridPoint{}) flatten(f);
    }
    for (std::uint32_t f = 0; f < c_.faces.size(); ++f) {
      pace_();
      if (!flat_[f] && boxes[f].overlaps(all)) items.push_back(f);
    }
    const OverlapTree tree(boxes, std::move(items), &context_);
    TriangleMeeting meeting;
    std::vector<std::uint32_t> others;
    for (std::uint32_t f = 0; f < c_.faces.size(); ++f) {
      search_pace_();
      if (!fresh_[f] || flat_[f]) continue;
      others.clear();
      tree.overlapping(boxes[f], 0, [&](std::uint32_t g) {
        if (g != f && (!fresh_[g] || g > f)) others.push_back(g);
      });
      std::sort(others.begin(), others.end());
      const GridTriangle t = corners(c_.faces[f]);
      for (const std::uint32_t g : others) {
        search_pace_();
        meet(t, c_.faces[f].v, corners(c_.faces[g]), c_.faces[g].v, meeting);
        if (meeting.cuts()) record(f, g, meeting);
      }
    }
    context_.checkpoint();
    std::sort(involved_.begin(), involved_.end());
    involved_.erase(std::unique(involved_.begin(), involved_.end()), involved_.end());
    // Those that meet nothing need to be looked at again only beside what changes.
    std::fill(fresh_.begin(), fresh_.end(), 0);
    for (const std::uint32_t f : involved_) fresh_[f] = 1;
  }

  /// Takes what is near to touch until nothing is; crossings are cut only afterwards, else bundles of nearly parallel
  /// sides would get new vertices wherever two of them cross, without an end.
  void tidy() {
    for (int pass = 0; pass < tidy_passes && pairs_ > 0; ++pass) {
      context_.checkpoint();
      if (merge_near_vertices()) find();
      forget_cuts();
      find_near();
      if (pool_.empty()) return;
      cut(true);
      unite();
      find();
    }
  }

  void forget_cuts() {
    pool_.clear(), becomes_.clear(), edge_points_.clear(), face_points_.clear(), segments_.clear();
    flat_.assign(c_.faces.size(), 0);
  }

  /// Makes one vertex of those, among the corners of the faces that meet another, that are within reach of each other.
  bool merge_near_vertices() {
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t f : involved_) vertices.insert(vertices.end(), c_.faces[f].v.begin(), c_.faces[f].v.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::vector<std::uint32_t> by_x = vertices;
    std::sort(by_x.begin(), by_x.end(), [&](std::uint32_t a, std::uint32_t b) {
      return c_.points[a] != c_.points[b] ? c_.points[a] < c_.points[b] : a < b;
    });
    // Each vertex goes to the lowest that is in reach and itself stays: chains of near vertices do not run together.
    std::vector<std::uint32_t> place(c_.points.size());
    for (std::size_t i = 0; i < by_x.size(); ++i) place[by_x[i]] = static_cast<std::uint32_t>(i);
    std::vector<std::uint32_t> target(c_.points.size(), by_place);
    bool any = false;
    const auto squared_reach = reach_ * reach_;
    for (const std::uint32_t v : vertices) {
      if (target[v] != by_place) continue;
      target[v] = v;
      const auto visit = [&](std::uint32_t w) {
        pace_();
        const GridPoint &p = c_.points[v], &q = c_.points[w];
        if (std::abs(static_cast<double>(q[0] - p[0])) > reach_) return false;
        double squared = 0;
        for (int d = 0; d < 3; ++d) squared += static_cast<double>(q[d] - p[d]) * static_cast<double>(q[d] - p[d]);
        if (target[w] == by_place && squared <= squared_reach) target[w] = v, any = true;
        return true;
      };
      for (std::size_t i = place[v] + 1; i < by_x.size() && visit(by_x[i]); ++i) continue;
      for (std::size_t i = place[v]; i > 0 && visit(by_x[i - 1]); --i) continue;
    }
    if (!any) return false;
    for (std::size_t f = 0; f < c_.faces.size(); ++f) {
      pace_();
      for (std::uint32_t& v : c_.faces[f].v)
        if (target[v] != by_place && target[v] != v) v = target[v], fresh_[f] = 1;
    }
    unite();
    return true;
  }

  /// Adds to the lists of cuts what is within reach of a face that meets another: such faces lose their area, and
  /// corners are taken to lie on the faces and sides that they are near.
  void find_near() {
    std::vector<char> marked(c_.faces.size(), 0);
    OverlapTree::Box all;
    std::vector<OverlapTree::Box> boxes(c_.faces.size());
    for (const std::uint32_t f : involved_) {
      marked[f] = 1;
      if (!flat_[f] && nearly_flat(corners(c_.faces[f]))) flatten(f);
      all.grow(box_of(c_.faces[f]));
    }
    const Vec3 margin = Vec3(1, 1, 1) * reach_;
    all.lo -= margin, all.hi += margin;
    std::vector<std::uint32_t> items;
    for (std::uint32_t f = 0; f < c_.faces.size(); ++f) {
      pace_();
      boxes[f] = box_of(c_.faces[f]);
      if (boxes[f].overlaps(all)) items.push_back(f);
    }
    const OverlapTree tree(boxes, std::move(items), &context_);
    const std::vector<std::uint32_t> involved = involved_;
    for (const std::uint32_t f : involved) {
      OverlapTree::Box box = boxes[f];
      box.lo -= margin, box.hi += margin;
      std::vector<std::uint32_t> others;
      tree.overlapping(box, 0, [&](std::uint32_t g) {
        if (g != f && (!marked[g] || g > f)) others.push_back(g);
      });
      std::sort(others.begin(), others.end());
      for (const std::uint32_t g : others) search_pace_(), near(f, g), near(g, f);
    }
  }

  bool nearly_flat(const GridTriangle& t) const {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const GridPoint &a = t[k], &b = t[(k + 1) % 3];
      longest = std::max(longest, length({b[0] - a[0], b[1] - a[1], b[2] - a[2]}));
    }
    return length(normal_of(t[0], t[1], t[2])) < reach_ * longest;
  }

  /// A corner within reach of another face is taken to lie on it.
  void near(std::uint32_t f, std::uint32_t g) {
    const GridTriangle t = corners(c_.faces[g]);
    const Triangle& ids = c_.faces[g].v;
    const GridPoint n = normal_of(t[0], t[1], t[2]);
    const double size = length(n);
    for (const std::uint32_t v : c_.faces[f].v) {
      if (v == ids[0] || v == ids[1] || v == ids[2]) continue;
      const GridPoint& p = c_.points[v];
      if (!flat_[g] && std::abs(static_cast<double>(volume6(t[0], t[1], t[2], p))) > reach_ * size) continue;
      bool done = false, inside = true;
      for (int k = 0; k < 3; ++k) {
        const GridPoint &a = t[k], &b = t[(k + 1) % 3];
        const GridPoint ab{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, ap{p[0] - a[0], p[1] - a[1], p[2] - a[2]};
        const GridPoint m = normal_of(a, b, p);
        Int128 facing = 0, along = 0, whole = 0;
        for (int d = 0; d < 3; ++d) {
          facing += static_cast<Int128>(m[d]) * n[d];
          along += static_cast<Int128>(ab[d]) * ap[d];
          whole += static_cast<Int128>(ab[d]) * ab[d];
        }
        if (facing <= 0) inside = false;
        if (length(m) > reach_ * std::sqrt(static_cast<double>(whole))) continue;
        if (along <= 0 || along >= whole) continue;
        edge_points_.push_back({edge_key_of(ids[k], ids[(k + 1) % 3]), keep(at_share(a, b, along, whole), v)});
        done = true;
      }
      if (!done && inside && !flat_[g]) face_points_.push_back({g, keep(exact(p), v)});
    }
  }

  static double length(const GridPoint& v) {
    double sum = 0;
    for (const std::int64_t x : v) sum += static_cast<double>(x) * static_cast<double>(x);
    return std::sqrt(sum);
  }

  /// A face without area disappears when its longest side gets its third corner.
  void flatten(std::uint32_t f) {
    const GridTriangle t = corners(c_.faces[f]);
    const Triangle& v = c_.faces[f].v;
    int side = 0;
    double longest = -1;
    for (int k = 0; k < 3; ++k) {
      const GridPoint &a = t[k], &b = t[(k + 1) % 3];
      const double l = length({b[0] - a[0], b[1] - a[1], b[2] - a[2]});
      if (l > longest) longest = l, side = k;
    }
    const GridPoint &a = t[side], &b = t[(side + 1) % 3], &p = t[(side + 2) % 3];
    Int128 along = 0, whole = 0;
    for (int d = 0; d < 3; ++d) {
      along += static_cast<Int128>(b[d] - a[d]) * (p[d] - a[d]);
      whole += static_cast<Int128>(b[d] - a[d]) * (b[d] - a[d]);
    }
    if (along <= 0 || along >= whole) return;
    edge_points_.push_back(
        {edge_key_of(v[side], v[(side + 1) % 3]), keep(at_share(a, b, along, whole), v[(side + 2) % 3])});
    flat_[f] = 1;
    involved_.push_back(f);
    ++pairs_;
  }

  void record(std::uint32_t f, std::uint32_t g, const TriangleMeeting& meeting) {
    ++pairs_;
    involved_.push_back(f), involved_.push_back(g);
    std::vector<std::uint32_t> place;
    for (const CommonPoint& p : meeting.points) {
      place.push_back(keep(p.point));
      on_face(f, p.on_first, place.back());
      on_face(g, p.on_second, place.back());
    }
    for (const CommonSegment& s : meeting.segments)
      segments_.push_back({s.in_first ? f : g, place[s.from], place[s.to], s.plane});
  }

  void on_face(std::uint32_t f, TrianglePlace on, std::uint32_t point) {
    const Triangle& v = c_.faces[f].v;
    if (on == in_interior)
      face_points_.push_back({f, point});
    else if (on >= 3)
      edge_points_.push_back({edge_key_of(v[on - 3], v[(on - 2) % 3]), point});
  }

  std::uint32_t number(const GridPoint& p) {
    const auto [number, added] = number_.insert(p, static_cast<std::uint32_t>(c_.points.size()));
    if (added) c_.points.push_back(p);
    return number;
  }

  std::uint32_t vertex_of(std::uint32_t p) {
    if (becomes_[p] != by_place) return becomes_[p];
    return number(pool_[p].rounded());
  }

  /// Points of an edge from its lower to its higher vertex, each place once.
  void sort_edge(EdgeKey edge, std::vector<std::uint32_t>& points) const {
    const GridPoint &a = c_.points[edge >> 32], &b = c_.points[edge & 0xffffffffu];
    const int axis = longest_axis({b[0] - a[0], b[1] - a[1], b[2] - a[2]});
    const bool up = b[axis] > a[axis];
    std::stable_sort(points.begin(), points.end(), [&](std::uint32_t p, std::uint32_t q) {
      const int c = compare(pool_[p], pool_[q], axis);
      return up ? c < 0 : c > 0;
    });
    points.erase(std::unique(points.begin(), points.end(),
                             [&](std::uint32_t p, std::uint32_t q) { return compare(pool_[p], pool_[q], axis) == 0; }),
                 points.end());
  }

  /// Replaces every face with a cut by its pieces; the pieces are fresh.
  /// @param others_stay_fresh  because their crossings are still to be cut
  std::size_t cut(bool others_stay_fresh) {
    std::stable_sort(edge_points_.begin(), edge_points_.end(),
                     [](const EdgePoint& a, const EdgePoint& b) { return a.edge < b.edge; });
    std::unordered_map<EdgeKey, std::vector<std::uint32_t>> on_edge;
    for (const EdgePoint& e : edge_points_) on_edge[e.edge].push_back(e.point);
    for (auto& [edge, points] : on_edge) search_pace_(), sort_edge(edge, points);
    const auto by_face = [](const auto& a, const auto& b) { return a.face < b.face; };
    std::stable_sort(face_points_.begin(), face_points_.end(), by_face);
    std::stable_sort(segments_.begin(), segments_.end(), by_face);

    std::vector<Face> kept;
    std::vector<char> fresh;
    std::size_t cuts = 0, next_point = 0, next_segment = 0;
    const std::size_t faces = c_.faces.size();
    for (std::uint32_t f = 0; f < faces; ++f) {
      pace_();
      const std::size_t p0 = next_point, s0 = next_segment;
      while (next_point < face_points_.size() && face_points_[next_point].face == f) ++next_point;
      while (next_segment < segments_.size() && segments_[next_segment].face == f) ++next_segment;
      const Triangle& v = c_.faces[f].v;
      std::array<const std::vector<std::uint32_t>*, 3> sides{};
      bool touched = next_point > p0 || next_segment > s0;
      if (!on_edge.empty())
        for (int k = 0; k < 3; ++k) {
          const auto it = on_edge.find(edge_key_of(v[k], v[(k + 1) % 3]));
          if (it != on_edge.end()) sides[k] = &it->second, touched = true;
        }
      if (!touched) {
        kept.push_back(c_.faces[f]);
        fresh.push_back(static_cast<char>(others_stay_fresh && fresh_[f]));
        continue;
      }
      search_pace_();
      ++cuts;
      const Face face = c_.faces[f];
      const std::size_t before = kept.size();
      if (flat_[f])
        pieces_of_flat(face, sides, kept);
      else
        pieces(face, sides, {face_points_.data() + p0, next_point - p0}, {segments_.data() + s0, next_segment - s0},
               kept);
      fresh.resize(fresh.size() + kept.size() - before, 1);
    }
    c_.faces = std::move(kept);
    fresh_ = std::move(fresh);
    return cuts;
  }

  void add_piece(const Face& face, const Triangle& v, std::vector<Face>& out) const {
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return;
    Face piece = face;
    piece.v = v;
    out.push_back(piece);
  }

  /// A face without area is a closed polygon of points on a line. Where it turns back along itself nothing is left; a
  /// fan of the rest keeps its boundary, which is all that counts.
  void pieces_of_flat(const Face& face, const std::array<const std::vector<std::uint32_t>*, 3>& sides,
                      std::vector<Face>& out) {
    std::vector<std::uint32_t> ring;
    for (int k = 0; k < 3; ++k) {
      ring.push_back(face.v[k]);
      if (sides[k] == nullptr) continue;
      std::vector<std::uint32_t> points;
      for (const std::uint32_t p : *sides[k]) points.push_back(vertex_of(p));
      if (face.v[k] > face.v[(k + 1) % 3]) std::reverse(points.begin(), points.end());
      ring.insert(ring.end(), points.begin(), points.end());
    }
    for (std::size_t i = 0; i < ring.size() && ring.size() > 2;) {
      const std::size_t n = ring.size(), before = (i + n - 1) % n, after = (i + 1) % n;
      if (ring[i] == ring[after]) {
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
      } else if (ring[before] == ring[after]) {
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(std::max(i, after)));
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(std::min(i, after)));
      } else {
        ++i;
        continue;
      }
      i = 0;
    }
    for (std::size_t i = 1; i + 1 < ring.size(); ++i) add_piece(face, {ring[0], ring[i], ring[i + 1]}, out);
  }

  void pieces(const Face& face, const std::array<const std::vector<std::uint32_t>*, 3>& sides,
              std::span<const FacePoint> points, std::span<const Segment> segments, std::vector<Face>& out) {
    FaceTriangulation cuts(corners(face));
    std::vector<std::uint32_t> ids(face.v.begin(), face.v.end());
    const auto add = [&](std::uint32_t p) {
      const int v = cuts.add_point(pool_[p]);
      if (v >= static_cast<int>(ids.size())) ids.push_back(vertex_of(p));
      return v;
    };
    for (const auto* side : sides)
      if (side != nullptr)
        for (const std::uint32_t p : *side) add(p);
    for (const FacePoint& p : points) add(p.point);
    std::vector<std::array<int, 2>> ends;
    for (const Segment& s : segments) {
      const int from = add(s.from), to = add(s.to);
      ends.push_back({from, to});
    }
    for (std::size_t i = 0; i < segments.size(); ++i)
      if (ends[i][0] >= 0 && ends[i][1] >= 0 && ends[i][0] != ends[i][1])
        cuts.add_segment(ends[i][0], ends[i][1], segments[i].plane);
    for (std::size_t i = ids.size(); i < cuts.points().size(); ++i) ids.push_back(number(cuts.points()[i].rounded()));
    cuts.improve([&](int v) { return ids[v]; });
    for (const auto& t : cuts.triangles()) add_piece(face, {ids[t[0]], ids[t[1]], ids[t[2]]}, out);
  }

  /// Faces with the same corners become one.
  void unite() {
    struct Entry {
      Triangle sorted;
      std::uint32_t face;
    };
    std::vector<Entry> entries;
    for (std::uint32_t f = 0; f < c_.faces.size(); ++f) {
      pace_();
      Triangle s = c_.faces[f].v;
      std::sort(s.begin(), s.end());
      if (s[0] == s[1] || s[1] == s[2]) continue;
      entries.push_back({s, f});
    }
    cancellable_sort(entries.begin(), entries.end(), &context_, [](const Entry& a, const Entry& b) {
      return a.sorted != b.sorted ? a.sorted < b.sorted : a.face < b.face;
    });
    std::vector<char> drop(c_.faces.size(), 1);
    for (std::size_t i = 0; i < entries.size();) {
      pace_();
      Face& first = c_.faces[entries[i].face];
      drop[entries[i].face] = 0;
      std::size_t j = i + 1;
      for (; j < entries.size() && entries[j].sorted == entries[i].sorted; ++j) {
        const Face& other = c_.faces[entries[j].face];
        first.net += runs_alike(first.v, other.v) ? other.net : -other.net;
        if (other.original && !first.original) first.original = true, first.source = other.source;
        if (fresh_[entries[j].face]) fresh_[entries[i].face] = 1;
      }
      i = j;
    }
    std::size_t n = 0;
    for (std::size_t f = 0; f < c_.faces.size(); ++f) {
      pace_();
      if (drop[f]) continue;
      c_.faces[n] = c_.faces[f];
      fresh_[n++] = fresh_[f];
    }
    c_.faces.resize(n);
    fresh_.resize(n);
  }

  static bool runs_alike(const Triangle& a, const Triangle& b) {
    int k = 0;
    while (b[k] != a[0]) ++k;
    return b[(k + 1) % 3] == a[1];
  }

  CrossingComplex& c_;
  const double first_reach_, most_reach_;
  Context& context_;
  Pace pace_;                               ///< of short steps
  Pace search_pace_{context_, long_steps};  ///< of searches and cuts
  NumberMap<GridPoint, GridHash> number_;
  std::vector<char> fresh_;  ///< faces made in the round before
  std::vector<char> flat_;   ///< faces without area
  std::vector<ExactPoint> pool_;
  std::vector<std::uint32_t> becomes_;   ///< of each point in the pool
  std::vector<std::uint32_t> involved_;  ///< faces that meet another
  std::vector<EdgePoint> edge_points_;
  std::vector<FacePoint> face_points_;
  std::vector<Segment> segments_;
  std::size_t pairs_ = 0;
  double reach_ = 0;  ///< grid steps
};

}  // namespace

CrossingReport resolve_crossings(CrossingComplex& complex, double first_reach, double most_reach, Context& context) {
  return CrossingResolver(complex, first_reach, most_reach, context).run();
}

}  // namespace tri
