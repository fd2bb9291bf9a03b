#include "meshops/operators/stitch_contours.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "meshops/editing/add_faces.hpp"
#include "meshops/holes/boundary_loops.hpp"
#include "meshops/holes/hole.hpp"
#include "meshops/joining/contour_triangulation.hpp"
#include "meshops/joining/facing_contours.hpp"
#include "meshops/search/local_spacing.hpp"

namespace tri {
namespace {

/// What grew until it stopped at another stretch may go on after that was joined.
constexpr int contour_passes = 4;

class Stitcher {
 public:
  Stitcher(MeshView view, const StitchContoursOptions& options, Context& context, Report& report)
      : view_(view), mesh_(view.mesh), options_(options), context_(context), report_(report),
        first_new_face_(mesh_.n_faces()), spacing_(local_spacing(view, &context)),
        facing_(view, spacing_, {options.max_gap, options.max_distance, options.max_turn}) {}

  void run() {
    std::vector<ContourPair> pairs;
    if (options_.pairs != ContourPairs::found)
      pairs = options_.reference ? options_.reference->contour_pairs(view_) : marked_pairs();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      context_.checkpoint();
      context_.progress("stitch-contours", 0.5 * static_cast<double>(i) / static_cast<double>(pairs.size()));
      join_given(pairs[i]);
    }
    const bool find = options_.pairs == ContourPairs::found || options_.pairs == ContourPairs::both ||
                      (options_.pairs == ContourPairs::automatic && pairs.empty());
    for (int pass = 0; find && pass < contour_passes; ++pass)
      if (!join_found(pass)) break;
    close_corners();
    if (joined_ > 0) report_.figures["contours joined"] = joined_;
    if (corners_ > 0) report_.figures["corners closed"] = corners_;
  }

 private:
  void skip(const char* reason) { ++report_.skipped[reason]; }

  bool is_boundary_run(const std::vector<VertexHandle>& contour, bool closed) const {
    const std::size_t n = contour.size();
    for (const VertexHandle v : contour)
      if (!mesh_.is_valid_handle(v) || mesh_.status(v).deleted()) return false;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
      const HalfedgeHandle h = mesh_.find_halfedge(contour[i], contour[(i + 1) % n]);
      if (!h.is_valid() || !mesh_.is_boundary(h) || !view_.may_fill({&h, 1})) return false;
    }
    return n > 0;
  }

  void join_given(const ContourPair& pair) {
    if (!is_boundary_run(pair.first, pair.closed) || !is_boundary_run(pair.second, pair.closed)) {
      skip("contour is not a free boundary");
      return;
    }
    ContourRun run{pair.first, {pair.second.rbegin(), pair.second.rend()}, pair.closed};
    if (pair.closed) {
      // Begin where the loops are nearest, so that they are not twisted against each other.
      std::size_t best_i = 0, best_j = 0;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < run.first.size(); ++i)
        for (std::size_t j = 0; j < run.second.size(); ++j) {
          const double d = (view_.point(run.first[i]) - view_.point(run.second[j])).sqrnorm();
          if (d < nearest) nearest = d, best_i = i, best_j = j;
        }
      std::rotate(run.first.begin(), run.first.begin() + static_cast<std::ptrdiff_t>(best_i), run.first.end());
      std::rotate(run.second.begin(), run.second.begin() + static_cast<std::ptrdiff_t>(best_j), run.second.end());
      run.first.push_back(run.first.front());
      run.second.push_back(run.second.front());
    }
    if (!join(run)) skip("contours do not fit");
  }

  bool join_found(int pass) {
    const auto before = report_.faces_added;
    const auto seeds = facing_.seeds();
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      context_.checkpoint();
      if (i % 16 == 0)
        context_.progress(
            "stitch-contours",
            0.5 + 0.5 * (pass + static_cast<double>(i) / static_cast<double>(seeds.size())) / contour_passes);
      if (is_corner(seeds[i].first) || is_corner(seeds[i].second)) continue;
      const auto run = facing_.grow(seeds[i]);
      if (run) join(*run);
    }
    return report_.faces_added > before;
  }

  bool is_new(HalfedgeHandle boundary) const {
    return mesh_.face_handle(mesh_.opposite_halfedge_handle(boundary)).idx() >= static_cast<int>(first_new_face_);
  }

  /// Whether the half-edge is on a small loop that stitching left. Such a loop is closed by itself afterwards; joined
  /// to the next one it would make a handle.
  bool is_corner(HalfedgeHandle start) const {
    if (!mesh_.is_boundary(start)) return false;
    bool stitched = false;
    HalfedgeHandle h = start;
    for (int edges = 0; edges < options_.max_corner_edges; ++edges) {
      stitched = stitched || is_new(h);
      h = mesh_.next_halfedge_handle(h);
      if (h == start) return stitched;
    }
    return false;
  }

  /// Whether the triangle of a step may be made, with its far diagonal as an inner edge or the end of the strip.
  bool allowed(const ContourRun& run, int i, int j, ContourStep step) const {
    const VertexHandle p = run.first[i], q = run.second[j];
    const bool on_first = step == ContourStep::first;
    const VertexHandle next = on_first ? run.first[i + 1] : run.second[j + 1];
    const VertexHandle apex = on_first ? q : p;
    if (next == apex || p == q) return true;  // contours that end in one vertex: no triangle is made there
    const VertexHandle a = on_first ? p : next, b = on_first ? next : q;
    const HalfedgeHandle base = mesh_.find_halfedge(a, b);
    if (!base.is_valid() || !mesh_.is_boundary(base) || !view_.may_fill({&base, 1})) return false;
    const HalfedgeHandle far_side = mesh_.find_halfedge(next, apex);
    if (far_side.is_valid() && !mesh_.is_boundary(mesh_.edge_handle(far_side))) return false;
    return turn_at(view_, base, a, b, apex) <= options_.max_turn;
  }

  bool join(const ContourRun& run) {
    std::vector<Vec3> first, second;
    for (const VertexHandle v : run.first) first.push_back(view_.point(v));
    for (const VertexHandle v : run.second) second.push_back(view_.point(v));
    const auto steps =
        triangulate_contours(first, second, [&](int i, int j, ContourStep s) { return allowed(run, i, j, s); });
    if (!steps) return false;
    std::vector<VertexTriple> strip;
    int i = 0, j = 0;
    for (const ContourStep s : *steps) {
      const VertexHandle p = run.first[i], q = run.second[j];
      if (s == ContourStep::first) {
        if (p != q && run.first[i + 1] != q) strip.push_back({p, run.first[i + 1], q});
        ++i;
      } else {
        if (p != q && run.second[j + 1] != p) strip.push_back({run.second[j + 1], q, p});
        ++j;
      }
    }
    const bool done = add(strip);
    joined_ += done;
    return done;
  }

  /// Adds a strip, or the parts of it that fit.
  bool add(std::span<const VertexTriple> strip) {
    if (strip.empty()) return false;
    std::vector<FaceHandle> added;
    if (add_faces(view_, strip, &added) == FitResult::fits) {
      report_.faces_added += added.size();
      for (const FaceHandle f : added) report_.touched_faces.push_back(static_cast<std::uint32_t>(f.idx()));
      for (const VertexTriple& t : strip)
        for (const VertexHandle v : t) report_.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
      return true;
    }
    if (strip.size() < 4) return false;
    const std::size_t half = strip.size() / 2;
    const bool left = add(strip.first(half)), right = add(strip.subspan(half));
    return left || right;
  }

  /// Pairs from the edge property: by value, the two unbroken runs of boundary half-edges that carry it.
  std::vector<ContourPair> marked_pairs() {
    std::vector<ContourPair> pairs;
    OpenMesh::EPropHandleT<int> mark;
    if (!mesh_.get_property_handle(mark, options_.pair_property)) return pairs;
    struct Contour {
      std::vector<VertexHandle> vertices;
      bool closed;
    };
    std::map<int, std::vector<Contour>> contours;
    const auto value = [&](HalfedgeHandle h) { return mesh_.property(mark, mesh_.edge_handle(h)); };
    for (const auto& cycle : boundary_cycles(view_, &context_)) {
      const std::size_t n = cycle.size();
      std::size_t start = 0;
      while (start < n && value(cycle[start]) == value(cycle[(start + n - 1) % n])) ++start;
      if (start == n) {
        if (value(cycle[0]) < 0) continue;
        Contour& c = contours[value(cycle[0])].emplace_back();
        c.closed = true;
        for (const HalfedgeHandle h : cycle) c.vertices.push_back(mesh_.from_vertex_handle(h));
        continue;
      }
      for (std::size_t i = 0; i < n;) {
        const int number = value(cycle[(start + i) % n]);
        Contour c{{mesh_.from_vertex_handle(cycle[(start + i) % n])}, false};
        for (; i < n && value(cycle[(start + i) % n]) == number; ++i)
          c.vertices.push_back(mesh_.to_vertex_handle(cycle[(start + i) % n]));
        if (number >= 0) contours[number].push_back(std::move(c));
      }
    }
    for (auto& [number, found] : contours) {
      if (found.size() != 2 || found[0].closed != found[1].closed)
        skip("pair without two contours");
      else
        pairs.push_back({std::move(found[0].vertices), std::move(found[1].vertices), found[0].closed});
    }
    return pairs;
  }

  void close_corners() {
    if (options_.max_corner_edges == 0 || report_.faces_added == 0) return;
    const auto cycles = boundary_cycles(view_, &context_);
    const auto sizes = component_sizes(view_, &context_);
    for (const auto& cycle : cycles) {
      context_.checkpoint();
      int stitched = 0;
      for (const HalfedgeHandle h : cycle) stitched += is_new(h);
      if (stitched == 0 || !view_.may_fill(cycle)) continue;
      Hole hole(view_, cycle);
      if (!hole.simple()) continue;
      // The outer rim of two small patches that were joined is no corner. A sheet with n edges around it has fewer than
      // n^2 / 2 faces.
      const auto faces = sizes[mesh_.face_handle(mesh_.opposite_halfedge_handle(cycle[0])).idx()];
      const auto edges = static_cast<std::size_t>(hole.size());
      if (2 * faces < edges * edges && 2 * stitched < hole.size() && hole.rim_of_sheet(faces)) continue;
      if (hole.size() > options_.max_corner_edges) {
        if (!hole.wider_than(reach(hole))) skip("corner larger than max-corner-edges");
        continue;
      }
      if (options_.reference && options_.reference->keeps_open(hole.vertices())) {
        skip("kept open by the reference");
        continue;
      }
      const auto triangles = hole.around_single_triangle()
                                 ? std::vector<VertexTriple>()
                                 : hole.triangulate(HoleStrategy::minimum_area_dihedral, hole.size(), context_);
      if (!triangles.empty() && width(hole, triangles) > reach(hole)) continue;  // an opening of the part
      if (!triangles.empty() && add_whole(triangles))
        ++corners_;
      else
        skip("corner without a triangulation");
    }
  }

  double reach(const Hole& hole) const {
    double widest = 0;
    for (const VertexHandle v : hole.vertices()) widest = std::max(widest, facing_.reach(v, v));
    return widest;
  }

  /// The diameter of a disc with the same ratio of area to circumference; twice the width of a long crack.
  double width(const Hole& hole, const std::vector<VertexTriple>& triangles) const {
    double area = 0, length = 0;
    for (const VertexTriple& t : triangles)
      area += 0.5 * ((view_.point(t[1]) - view_.point(t[0])) % (view_.point(t[2]) - view_.point(t[0]))).norm();
    const auto& rim = hole.vertices();
    for (std::size_t i = 0; i < rim.size(); ++i)
      length += (view_.point(rim[(i + 1) % rim.size()]) - view_.point(rim[i])).norm();
    return length > 0 ? 4 * area / length : 0;
  }

  bool add_whole(const std::vector<VertexTriple>& triangles) {
    return check_faces(view_, triangles) == FitResult::fits && add(triangles);
  }

  MeshView view_;
  const OpenMesh::TriConnectivity& mesh_;
  const StitchContoursOptions& options_;
  Context& context_;
  Report& report_;
  std::size_t first_new_face_;
  std::vector<double> spacing_;
  FacingContours facing_;
  int joined_ = 0, corners_ = 0;
};

}  // namespace

const OptionSchema& StitchContoursOptions::schema() {
  using O = StitchContoursOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("pairs", &O::pairs,
                  {{"auto", ContourPairs::automatic},
                   {"given", ContourPairs::given},
                   {"found", ContourPairs::found},
                   {"both", ContourPairs::both}},
                  {.help = "where the pairs of contours come from"})
          .number("max-gap", &O::max_gap,
                  {.min = 0, .min_open = true, .help = "widest gap of found pairs, times the local spacing"})
          .number("max-distance", &O::max_distance,
                  {.unit = "mm",
                   .min = 0,
                   .min_open = true,
                   .infinite = true,
                   .help = "widest gap of found pairs, in place of max-gap"})
          .angle("max-turn", &O::max_turn,
                 {.min = 0, .max = 179, .help = "largest angle between a new triangle and the face it joins"})
          .integer("max-corner-edges", &O::max_corner_edges,
                   {.unit = "edges",
                    .min = 0,
                    .max = 200,
                    .help = "longer loops left between contours stay open; 0 closes none"})
          .text("pair-property", &O::pair_property, {.help = "edge property that numbers given pairs"});
  return schema;
}

Report stitch_contours(MeshView view, const StitchContoursOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  Report report;
  report.operation = "stitch-contours";
  Stitcher(view, options, context, report).run();
  std::sort(report.touched_vertices.begin(), report.touched_vertices.end());
  report.touched_vertices.erase(std::unique(report.touched_vertices.begin(), report.touched_vertices.end()),
                                report.touched_vertices.end());
  context.progress("stitch-contours", 1);
  return report;
}

}  // namespace tri
