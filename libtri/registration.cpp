#include "libtri/registration.hpp"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <thread>

#include "libtri/model/outward_normals.hpp"
#include "libtri/model/trim_region.hpp"
#include "libtri/surfaces/curve_piece.hpp"
#include "libtri/surfaces/surface_patch.hpp"
#include "libtri/triangulation/point_order.hpp"
#include "meshops/limits.hpp"
#include "meshops/random_stream.hpp"
#include "meshops/search/box_tree.hpp"

namespace tri {

namespace {

constexpr std::size_t registration_block = 4096;
// A curve shared by two faces is searched once where both say the same within this share of the diagonal.
constexpr double same_curve = 2e-8;
// Pieces that could better a distance by less than this share of the diagonal are not looked into.
constexpr double accuracy = 1e-8;
// Distances closer than this share of the diagonal are equal.
constexpr double tie_share = 1e-10;
// Points between two looks at the context.
constexpr std::size_t checkpoint_interval = 64;
// Consecutive points that share the items that matter for them, if these are few.
constexpr std::size_t group_size = 16, most_gathered = 32;
constexpr double gathered_share = 0.02;

tbb::task_arena arena_of(const Context& context) {
  const int cores = tbb::info::default_concurrency();
  return tbb::task_arena(context.threads > 0 ? std::min(context.threads, cores) : cores);
}

}  // namespace

struct Registration::Impl {
  Impl(const CadModel& model_in, Context& context);

  void add_curves();
  void add_kinks(std::uint32_t face);
  bool repeats(std::uint32_t curve) const;

  // What one thread needs beside the model.
  struct Search {
    explicit Search(const Impl& impl_in) : impl(impl_in), seen(impl_in.model.faces.size(), 0) {}
    FootCandidate closest(const Vec3& p);
    /// Gathers the items that matter for every point in the box; false if they are too many to be worth it.
    /// @param inside    a point in the box, whose distance from the model is `distance`
    bool gather(const Vec3& box_low, const Vec3& box_high, double distance);
    /// As `closest`, among the items gathered.
    FootCandidate closest_gathered(const Vec3& p);
    void begin(const Vec3& p, FootCandidate& best);
    /// The feet of a few points that are near one another.
    void register_group(std::span<const Vec3> points, std::span<const std::uint32_t> group, std::vector<Foot>& feet);
    void visit(std::uint32_t item, const Vec3& p, FootCandidate& best);

    const Impl& impl;
    std::vector<std::uint32_t> seen;  // per face: the last point whose closed-form feet were tried
    std::uint32_t serial = 0;
    std::uint32_t warm = no_index;
    std::vector<std::uint32_t> gathered;
  };

  // A distance, rounded down, that no part of the item goes below.
  float bound(std::uint32_t item, const Vec3& p) const {
    const auto patch_count = static_cast<std::uint32_t>(patches.size());
    const double least = item < patch_count ? patches[item].lower_bound(p) * (1 - 1e-6) - 1e-6 * diagonal
                                            : pieces[item - patch_count].lower_bound(p) - tie;
    return least > 0 ? static_cast<float>(least) * (1 - 1e-6f) : 0;
  }
  Foot finish(const Vec3& p, FootCandidate c) const;

  CadModel model;  // without polylines
  double diagonal = 0;
  std::vector<TrimRegion> regions;
  std::vector<SurfacePatch> patches;
  std::vector<FaceCurve> curves;
  std::vector<CurvePiece> pieces;
  PseudoNormals pseudo_normals;
  BoxTree tree;  // items: patches, then pieces
  Vec3 low{0, 0, 0}, high{0, 0, 0};
  double tolerance = 0, tie = 0;
};

Registration::Impl::Impl(const CadModel& model_in, Context& context) {
  context.checkpoint();
  context.progress("index model", 0);
  for (const CadFace& face : model_in.faces) {
    CadFace copy = face;
    for (TrimLoop& loop : copy.loops)
      for (Coedge& coedge : loop.coedges) coedge.polyline = {};
    model.faces.push_back(std::move(copy));
  }
  for (const CadEdge& edge : model_in.edges) {
    CadEdge copy = edge;
    copy.polyline = {};
    model.edges.push_back(std::move(copy));
  }
  model.vertices = model_in.vertices;
  const std::size_t n = model.faces.size();
  regions.reserve(n);
  for (const CadFace& face : model.faces) regions.emplace_back(face);

  diagonal = model_in.diagonal;
  if (!(diagonal > 0)) {
    // A model that does not say its size: from samples of its faces.
    bool first = true;
    for (std::size_t f = 0; f < n; ++f) {
      const TrimRegion& r = regions[f];
      for (int i = 0; i <= 16; ++i) {
        for (int j = 0; j <= 16; ++j) {
          const Vec3 p = model.faces[f].surface->point(r.u_min() + (r.u_max() - r.u_min()) * i / 16,
                                                       r.v_min() + (r.v_max() - r.v_min()) * j / 16);
          if (first) low = high = p;
          first = false;
          low.minimize(p);
          high.maximize(p);
        }
      }
    }
    diagonal = (high - low).norm();
  }
  tolerance = accuracy * diagonal;
  tie = tie_share * diagonal;

  std::vector<std::vector<SurfacePatch>> per_face(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t f) {
    make_patches(model.faces[f], regions[f], static_cast<std::uint32_t>(f), diagonal, context, per_face[f]);
  });
  context.checkpoint();
  context.progress("index model", 0.5);
  for (const auto& some : per_face) patches.insert(patches.end(), some.begin(), some.end());

  add_curves();
  pseudo_normals = PseudoNormals(model, regions, curves);
  std::vector<std::vector<CurvePiece>> per_curve(curves.size());
  tbb::parallel_for(std::size_t{0}, curves.size(), [&](std::size_t c) {
    const auto index = static_cast<std::uint32_t>(c);
    if (!context.cancelled() && !repeats(index))
      make_pieces(curves[c], index, *model.faces[curves[c].face].surface, diagonal, context, per_curve[c]);
  });
  context.checkpoint();
  context.progress("index model", 0.8);
  for (const auto& some : per_curve) pieces.insert(pieces.end(), some.begin(), some.end());

  std::vector<Box> boxes;
  boxes.reserve(patches.size() + pieces.size());
  for (const SurfacePatch& patch : patches) boxes.push_back(patch.box());
  for (const CurvePiece& piece : pieces) boxes.push_back(piece.box());
  if (boxes.empty()) return;
  low = boxes[0].low;
  high = boxes[0].high;
  for (const Box& b : boxes) {
    low.minimize(b.low);
    high.maximize(b.high);
  }
  tree = BoxTree(boxes);
  context.progress("index model", 1);
}

void Registration::Impl::add_curves() {
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    for (const TrimLoop& loop : model.faces[f].loops) {
      for (const Coedge& coedge : loop.coedges) {
        const CadEdge& edge = model.edges[coedge.edge];
        FaceCurve curve;
        curve.pcurve = coedge.pcurve;
        curve.first = coedge.first;
        curve.last = coedge.last;
        curve.edge = coedge.edge;
        curve.face = f;
        curve.point = edge.degenerate;
        const bool seam = edge.faces.size() == 2 && edge.faces[0] == edge.faces[1];
        curve.boundary = !edge.degenerate && !seam;
        curves.push_back(curve);
      }
    }
    add_kinks(f);
  }
}

void Registration::Impl::add_kinks(std::uint32_t face) {
  const Surface& surface = *model.faces[face].surface;
  const TrimRegion& r = regions[face];
  class IsoLine final : public Curve2 {
   public:
    IsoLine(int axis, double at) : axis_(axis), at_(at) {}
    Vec2 point(double t) const override { return axis_ == 0 ? Vec2(at_, t) : Vec2(t, at_); }
    CurvePoint2 evaluate(double t) const override {
      return {point(t), axis_ == 0 ? Vec2(0, 1) : Vec2(1, 0), Vec2(0, 0)};
    }
    CurveBounds<Vec2> bounds(double, double) const override {
      return {axis_ == 0 ? Vec2(0, 1) : Vec2(1, 0), Vec2(0, 0), Vec2(0, 0)};
    }
    std::vector<ParameterBreak> breaks() const override { return {}; }

   private:
    int axis_;
    double at_;
  };
  for (int axis = 0; axis < 2; ++axis) {
    const double period = axis == 0 ? surface.u_period() : surface.v_period();
    const double begin = axis == 0 ? r.u_min() : r.v_min(), end = axis == 0 ? r.u_max() : r.v_max();
    for (const ParameterBreak& b : axis == 0 ? surface.u_breaks() : surface.v_breaks()) {
      if (b.continuity > 0) continue;
      double at = b.at;
      if (period > 0) at -= std::floor((at - begin) / period) * period;
      if (!(at > begin && at < end)) continue;
      FaceCurve curve;
      curve.pcurve = std::make_shared<IsoLine>(axis, at);
      curve.first = axis == 0 ? r.v_min() : r.u_min();
      curve.last = axis == 0 ? r.v_max() : r.u_max();
      curve.face = face;
      curve.boundary = false;
      curve.inside_only = true;
      curves.push_back(curve);
    }
  }
}

bool Registration::Impl::repeats(std::uint32_t index) const {
  const FaceCurve& c = curves[index];
  if (c.edge < 0 || c.point) return false;
  for (const std::uint32_t use : pseudo_normals.uses(c.edge)) {
    const FaceCurve& other = curves[use];
    if (use >= index || other.first != c.first || other.last != c.last) continue;
    constexpr int samples = 24;
    double most = 0;
    for (int i = 0; i <= samples; ++i) {
      const double t = c.first + (c.last - c.first) * i / samples;
      const Vec2 a = c.pcurve->point(t), b = other.pcurve->point(t);
      most = std::max(
          most,
          (model.faces[c.face].surface->point(a[0], a[1]) - model.faces[other.face].surface->point(b[0], b[1])).norm());
    }
    if (most <= same_curve * diagonal) return true;
  }
  return false;
}

void Registration::Impl::Search::visit(std::uint32_t item, const Vec3& p, FootCandidate& best) {
  const auto patch_count = static_cast<std::uint32_t>(impl.patches.size());
  if (item >= patch_count) {
    const CurvePiece& piece = impl.pieces[item - patch_count];
    if (piece.lower_bound(p) > best.distance + impl.tie) return;
    const FaceCurve& curve = impl.curves[piece.curve];
    closest_on_piece(piece, item, curve, *impl.model.faces[curve.face].surface, impl.regions[curve.face], p,
                     impl.tolerance, best);
    return;
  }
  const SurfacePatch& patch = impl.patches[item];
  if (patch.closed_form) {
    if (seen[patch.face] == serial) return;
    if (patch.lower_bound(p) * (1 - 1e-6) - 1e-6 * impl.diagonal > best.distance) return;
    seen[patch.face] = serial;
    closest_in_closed_form(*impl.model.faces[patch.face].surface, impl.regions[patch.face], patch.face, item, p, best);
    return;
  }
  if (patch.lower_bound(p) * (1 - 1e-6) - 1e-6 * impl.diagonal > best.distance) return;
  closest_on_patch(patch, item, *impl.model.faces[patch.face].surface, impl.regions[patch.face], p, impl.tolerance,
                   best);
}

void Registration::Impl::Search::begin(const Vec3& p, FootCandidate& best) {
  best.tie = impl.tie;
  best.faces = impl.model.faces.data();
  best.chance = 0;
  for (int k = 0; k < 3; ++k) best.chance = mix_bits(best.chance ^ std::bit_cast<std::uint64_t>(p[k] + 0.0));
  ++serial;
  if (warm != no_index) visit(warm, p, best);
}

bool Registration::Impl::Search::gather(const Vec3& box_low, const Vec3& box_high, double distance) {
  const Vec3 center = (box_low + box_high) / 2;
  const double radius = (box_high - box_low).norm() / 2;
  // The distance from the model grows no faster than the way one goes: nothing in the box is farther from it than this.
  const double farthest = distance + 2 * radius;
  const double reach = (farthest + radius) * (1 + 1e-6) + 2 * impl.tie;
  gathered.clear();
  impl.tree.search(
      center, [&] { return gathered.size() <= most_gathered ? reach : 0; },
      [&](std::uint32_t item) { return impl.bound(item, center); },
      [&](std::uint32_t item) { gathered.push_back(item); });
  return gathered.size() <= most_gathered;
}

FootCandidate Registration::Impl::Search::closest_gathered(const Vec3& p) {
  FootCandidate best;
  const std::uint32_t first = warm;
  begin(p, best);
  for (const std::uint32_t item : gathered)
    if (item != first) visit(item, p, best);
  warm = std::isfinite(best.distance) ? best.item : no_index;
  return best;
}

FootCandidate Registration::Impl::Search::closest(const Vec3& p) {
  FootCandidate best;
  const std::uint32_t first = warm;
  begin(p, best);
  const auto limit = [&] { return best.distance + impl.tie; };
  impl.tree.search(
      p, limit, [&](std::uint32_t item) { return impl.bound(item, p); },
      [&](std::uint32_t item) {
        if (item != first) visit(item, p, best);
      });
  if (!std::isfinite(best.distance)) {
    // So far away that single precision overflows in the tree.
    const auto items = static_cast<std::uint32_t>(impl.patches.size() + impl.pieces.size());
    ++serial;
    for (std::uint32_t item = 0; item < items; ++item) visit(item, p, best);
  }
  warm = std::isfinite(best.distance) ? best.item : no_index;
  return best;
}

void Registration::Impl::Search::register_group(std::span<const Vec3> points, std::span<const std::uint32_t> group,
                                                std::vector<Foot>& feet) {
  Vec3 box_low = points[group[0]], box_high = box_low;
  for (const std::uint32_t i : group) {
    box_low.minimize(points[i]);
    box_high.maximize(points[i]);
  }
  bool first = true, few = false;
  for (const std::uint32_t i : group) {
    const Vec3& p = points[i];
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
    const FootCandidate c = few ? closest_gathered(p) : closest(p);
    feet[i] = impl.finish(p, c);
    if (first && (box_high - box_low).norm() < gathered_share * impl.diagonal)
      few = gather(box_low, box_high, c.distance);
    first = false;
  }
}

Foot Registration::Impl::finish(const Vec3& p, FootCandidate c) const {
  Foot foot;
  if (!std::isfinite(c.distance)) return foot;
  std::uint32_t curve = no_index;
  if (c.on_curve) {
    curve = pieces[c.item - patches.size()].curve;
    if (curves[curve].boundary) {
      // The same edge as seen from a face of lower index wins a tie.
      const double share = (c.t - curves[curve].first) / (curves[curve].last - curves[curve].first);
      for (const std::uint32_t use : pseudo_normals.uses(curves[curve].edge)) {
        const FaceCurve& other = curves[use];
        if (other.face >= c.face) continue;
        const Surface& surface = *model.faces[other.face].surface;
        const double guess = other.first + share * (other.last - other.first);
        const double t = closest_parameter(other, surface, p, other.first, other.last, guess);
        const Vec2 uv = other.pcurve->point(t);
        const Vec3 at = surface.point(uv[0], uv[1]);
        if ((at - p).norm() > c.distance + tie) continue;
        c.distance = (at - p).norm();
        c.foot = at;
        c.uv = uv;
        c.face = other.face;
        c.t = t;
        curve = use;
      }
    }
  }
  const CadFace& face = model.faces[c.face];
  Vec3 normal;
  const double length = c.normal.norm();
  if (!c.on_curve && !patches[c.item].closed_form &&
      length > 1e-6 * patches[c.item].first[0] * patches[c.item].first[1]) {
    normal = c.normal / (face.reversed ? -length : length);
  } else {
    normal = outward_normal(face, regions[c.face], c.uv);
  }
  Vec3 side = normal;
  if (curve != no_index) {
    side = pseudo_normals.at(model, regions, curves, curve, c.t);
    if (curves[curve].point && side.norm() > 1e-3) normal = side / side.norm();
  }
  foot.point = c.foot;
  foot.uv = c.uv;
  foot.deviation = ((p - c.foot) | side) < 0 ? -c.distance : c.distance;
  for (int k = 0; k < 3; ++k) foot.normal[k] = static_cast<float>(normal[k]);
  foot.face = static_cast<std::int32_t>(c.face);
  if (curve != no_index && curves[curve].boundary) foot.edge = curves[curve].edge;
  return foot;
}

Registration::Registration(const CadModel& model, Context& context) {
  arena_of(context).execute([&] { impl_ = std::make_unique<Impl>(model, context); });
}
Registration::Registration(const CadModel& model) {
  Context context;
  impl_ = std::make_unique<Impl>(model, context);
}
Registration::~Registration() = default;
Registration::Registration(Registration&&) noexcept = default;

std::vector<std::uint32_t> Registration::order_of(std::span<const Vec3> points) const {
  return morton_order(points, impl_->low, impl_->high);
}

std::vector<Foot> Registration::register_points(std::span<const Vec3> points, Context& context) const {
  const Impl& impl = *impl_;
  std::vector<Foot> feet(points.size());
  context.checkpoint();
  context.progress("register", 0);
  const std::vector<std::uint32_t> order = order_of(points);
  const std::size_t blocks = (points.size() + registration_block - 1) / registration_block;
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<std::size_t> done{0};
  arena_of(context).execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, blocks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          Impl::Search search(impl);
          for (std::size_t block = range.begin(); block != range.end(); ++block) {
            // Each block starts anew, so that the result does not depend on which thread did what before.
            search.warm = no_index;
            const std::size_t end = std::min(points.size(), (block + 1) * registration_block);
            for (std::size_t k = block * registration_block; k < end; k += group_size) {
              if (k % checkpoint_interval == 0) context.checkpoint();
              search.register_group(points, std::span(order).subspan(k, std::min(group_size, end - k)), feet);
            }
            const std::size_t count = ++done;
            if (std::this_thread::get_id() == caller)
              context.progress("register", static_cast<double>(count) / static_cast<double>(blocks));
          }
        },
        tbb::simple_partitioner());
  });
  context.checkpoint();
  context.progress("register", 1);
  return feet;
}

}  // namespace tri
