#include "meshops/operators/fill_holes.hpp"

#include <fmt/format.h>

#include <array>
#include <map>
#include <set>

#include "meshops/crossings/self_intersections.hpp"
#include "meshops/editing/add_faces.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/holes/boundary_loops.hpp"
#include "meshops/holes/fairing.hpp"
#include "meshops/holes/filling_obstacles.hpp"
#include "meshops/holes/hole_islands.hpp"
#include "meshops/holes/refine_faces.hpp"

namespace tri {

const OptionSchema& FillHolesOptions::schema() {
  using O = FillHolesOptions;
  static const OptionSchema schema =
      Schema<O>()
          .choice("strategy", &O::strategy,
                  {{"nearest-diagonal", HoleStrategy::nearest_diagonal},
                   {"minimum-area-dihedral", HoleStrategy::minimum_area_dihedral},
                   {"minimum-area", HoleStrategy::minimum_area},
                   {"least-bending", HoleStrategy::least_bending}},
                  {.help = "how a hole is triangulated"})
          .integer("max-edges", &O::max_edges, {.unit = "edges", .min = 3, .help = "loops with more edges stay open"})
          .number("max-diameter", &O::max_diameter,
                  {.unit = "mm", .min = 0, .infinite = true, .help = "loops with two vertices farther apart stay open"})
          .integer("max-dynamic-edges", &O::max_dynamic_edges,
                   {.unit = "edges", .min = 3, .max = 1000, .help = "longer loops are optimised piece by piece"})
          .boolean("refine", &O::refine, {.help = "puts vertices into the holes, as dense as at the rim"})
          .number("growth", &O::growth,
                  {.min = 0, .max = 10, .help = "growth of edges by distance from the rim when refining; 0: none"})
          .choice("fair", &O::fair,
                  {{"none", Fairness::none},
                   {"position", Fairness::position},
                   {"tangent", Fairness::tangent},
                   {"curvature", Fairness::curvature}},
                  {.help = "refines, and makes the filling go on smoothly from its surroundings"});
  return schema;
}

namespace {

constexpr std::size_t most_notes = 10;

/// What to do with every boundary loop, then the doing.
class HoleFiller {
 public:
  HoleFiller(MeshView view, const FillHolesOptions& options, Context& context, Report& report)
      : view_(view), options_(options), context_(context), report_(report) {}

  void run() {
    context_.progress("fill-holes", 0);
    sort_loops();
    find_islands();
    if (holes_.empty()) {
      context_.progress("fill-holes", 1);
      return;
    }
    std::vector<std::vector<VertexHandle>> rims;
    for (const Hole& hole : holes_) rims.push_back(hole.vertices());
    FillingObstacles obstacles(view_, rims);
    for (std::size_t i = 0; i < holes_.size(); ++i) {
      context_.checkpoint();
      context_.progress("fill-holes", static_cast<double>(i) / static_cast<double>(holes_.size()));
      obstacles.start(i);
      fill(i, obstacles);
    }
    context_.progress("fill-holes", 1);
  }

 private:
  void skip(const char* reason) { ++report_.skipped[reason]; }
  void count(const char* figure, double more = 1) { report_.figures[figure] += more; }

  void sort_loops() {
    const auto cycles = boundary_cycles(view_, &context_);
    if (cycles.empty()) return;
    const auto sizes = component_sizes(view_, &context_);
    for (const auto& cycle : cycles) {
      context_.checkpoint();
      if (!view_.may_fill(cycle)) continue;
      if (Hole(view_, cycle).simple())
        sort_loop(cycle, sizes, false);
      else
        sort_loop_that_meets_itself(cycle, sizes);
    }
  }

  /// An island that touches the rim of its hole makes one outline with it; other loops are cut apart.
  void sort_loop_that_meets_itself(const std::vector<HalfedgeHandle>& cycle, const std::vector<std::size_t>& sizes) {
    const auto parts = simple_loops(view_, cycle);
    std::size_t sheets = 0;
    for (const auto& loop : parts) sheets += is_sheet(Hole(view_, loop), sizes);
    if (sheets > 0 && sheets < parts.size()) {
      count("islands joined", static_cast<double>(sheets));
      sort_loop(cycle, sizes, true);
      return;
    }
    count("loops cut apart where they meet themselves");
    for (const auto& loop : parts) sort_loop(loop, sizes, true);
  }

  bool is_sheet(const Hole& hole, const std::vector<std::size_t>& sizes) const {
    return hole.around_single_triangle() || hole.rim_of_sheet(sizes[hole.face_at_rim().idx()]);
  }

  void sort_loop(const std::vector<HalfedgeHandle>& loop, const std::vector<std::size_t>& sizes, bool part) {
    const Hole hole(view_, loop);
    const bool single = hole.around_single_triangle(), sheet = is_sheet(hole, sizes);
    const char* reason = hole.size() > options_.max_edges         ? "loop longer than max-edges"
                         : hole.wider_than(options_.max_diameter) ? "loop wider than max-diameter"
                         : single                                 ? "rim of a single triangle"
                         : sheet                                  ? "rim of a sheet"
                         : options_.reference && options_.reference->keeps_open(hole.vertices())
                             ? "kept open by the reference"
                             : nullptr;
    if (sheet) {
      islands_.push_back(loop);
      island_reasons_.push_back(reason);
    } else if (reason) {
      skip(reason);
    } else {
      holes_.push_back(hole);
      loops_.push_back(loop);
      is_part_.push_back(part);
    }
  }

  void find_islands() {
    const std::vector<int> in = find_hole_islands(view_, holes_, islands_, context_);
    islands_of_.resize(holes_.size());
    for (std::size_t i = 0; i < islands_.size(); ++i) {
      if (in[i] < 0)
        skip(island_reasons_[i]);
      else
        islands_of_[static_cast<std::size_t>(in[i])].push_back(i);
    }
    for (std::size_t h = 0; h < holes_.size(); ++h) {
      std::vector<std::size_t> joined;
      for (const std::size_t i : islands_of_[h]) {
        if (holes_[h].join_island(islands_[i]))
          joined.push_back(i);
        else
          skip("island without a way to its hole");
      }
      islands_of_[h] = joined;
    }
  }

  void fill(std::size_t i, FillingObstacles& obstacles) {
    const auto fill_one = [&](const Hole& hole) {
      return hole.fill(options_.strategy, options_.max_dynamic_edges, obstacles, context_);
    };
    HoleFilling filling = fill_one(holes_[i]);
    std::vector<FaceHandle> added;
    FitResult fit = filling.triangles.empty() ? FitResult::edge_in_use : add_faces(view_, filling.triangles, &added);
    if (fit != FitResult::fits && !islands_of_[i].empty()) {
      report_.skipped["island without a way to its hole"] += islands_of_[i].size();
      islands_of_[i].clear();
      filling = fill_one(Hole(view_, loops_[i]));
      fit = filling.triangles.empty() ? FitResult::edge_in_use : add_faces(view_, filling.triangles, &added);
    }
    if (fit != FitResult::fits) {
      skip(is_part_[i] && fit == FitResult::vertex_not_manifold ? "loop meets itself in a vertex"
                                                                : "no triangulation without an existing edge");
      return;
    }
    count("holes filled");
    if (!islands_of_[i].empty()) count("islands joined", static_cast<double>(islands_of_[i].size()));
    if (filling.in_pieces) count("holes optimised in pieces");
    std::size_t crossings = filling.crossings;
    refine_and_fair(added, obstacles, crossings);
    obstacles.add(i, added);
    report_.faces_added += added.size();
    for (const FaceHandle f : added) report_.touched_faces.push_back(static_cast<std::uint32_t>(f.idx()));
    for (const VertexHandle v : holes_[i].vertices())
      report_.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
    if (crossings > 0) tell_crossings(holes_[i], crossings);
  }

  /// @param crossings  of the filling; updated
  void refine_and_fair(std::vector<FaceHandle>& faces, const FillingObstacles& obstacles, std::size_t& crossings) {
    if (!options_.refine && options_.fair == Fairness::none) return;
    std::vector<VertexHandle> inner = refine_faces(
        view_, faces, options_.growth, [&](const VertexTriple& t) { return obstacles.crossings(t); }, context_);
    report_.vertices_added += inner.size();
    for (const VertexHandle v : inner) report_.touched_vertices.push_back(static_cast<std::uint32_t>(v.idx()));
    crossings = crossing_faces(faces, obstacles).count;
    if (options_.fair == Fairness::none || inner.empty()) return;
    const std::vector<VertexHandle> all = inner;
    std::vector<Vec3> before;
    for (const VertexHandle v : all) before.push_back(view_.point(v));
    const auto back = [&] {
      for (std::size_t k = 0; k < all.size(); ++k) set_point(view_, all[k], before[k]);
    };
    // Where the faired filling would cross something it keeps the place that it had.
    for (int round = 0; round < 5 && !inner.empty(); ++round) {
      if (!fair_filling(inner)) {
        back();
        count("fillings not faired");
        return;
      }
      const Crossings now = crossing_faces(faces, obstacles);
      if (now.count <= crossings) {
        crossings = now.count;
        if (round > 0) count("fillings faired in part, since they would cross the mesh");
        return;
      }
      back();
      std::set<VertexHandle> pinned;
      for (const FaceHandle f : now.faces)
        for (auto v = view_.mesh.cfv_iter(f); v.is_valid(); ++v) {
          pinned.insert(*v);
          for (auto w = view_.mesh.cvv_iter(*v); w.is_valid(); ++w) pinned.insert(*w);
        }
      std::erase_if(inner, [&](VertexHandle v) { return pinned.count(v) > 0; });
    }
    count("fillings not faired, since they would cross the mesh");
  }

  struct Crossings {
    std::size_t count = 0;
    std::vector<FaceHandle> faces;  ///< of the filling, that take part
  };

  Crossings crossing_faces(const std::vector<FaceHandle>& faces, const FillingObstacles& obstacles) const {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
    std::map<std::array<double, 3>, std::uint32_t> number;  // vertices in one place are one here
    Crossings found;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (i % 256 == 0) context_.checkpoint();
      VertexTriple corners;
      Triangle triangle;
      std::size_t k = 0;
      for (auto it = view_.mesh.cfv_ccwiter(faces[i]); it.is_valid(); ++it, ++k) {
        const Vec3& p = view_.point(*it);
        const auto [at, fresh] = number.try_emplace({p[0], p[1], p[2]}, static_cast<std::uint32_t>(points.size()));
        if (fresh) points.push_back(p);
        corners[k] = *it;
        triangle[k] = at->second;
      }
      triangles.push_back(triangle);
      const int crossings = obstacles.crossings(corners);
      found.count += static_cast<std::size_t>(crossings);
      if (crossings > 0) found.faces.push_back(faces[i]);
    }
    for (const auto& [t, u] : self_intersections(points, triangles, context_, Neighbors::judge)) {
      ++found.count;
      found.faces.push_back(faces[t]);
      found.faces.push_back(faces[u]);
    }
    return found;
  }

  /// Moves the vertices of a filling; false if neither kind of weight allows it.
  bool fair_filling(const std::vector<VertexHandle>& vertices) {
    const Continuity continuity = options_.fair == Fairness::position  ? Continuity::position
                                  : options_.fair == Fairness::tangent ? Continuity::tangent
                                                                       : Continuity::curvature;
    for (const FairingWeights weights : {FairingWeights::cotangent, FairingWeights::uniform}) {
      const FairedPoints faired = faired_points(view_, vertices, continuity, weights, context_);
      if (faired.outcome != FairingOutcome::done) continue;
      for (std::size_t i = 0; i < faired.points.size(); ++i) set_point(view_, faired.vertices[i], faired.points[i]);
      return true;
    }
    return false;
  }

  void tell_crossings(const Hole& hole, std::size_t crossings) {
    count("fillings that cross the mesh");
    if (report_.notes.size() >= most_notes) return;
    Vec3 middle(0, 0, 0);
    for (const Vec3& p : hole.points()) middle += p / static_cast<double>(hole.size());
    report_.notes.push_back(fmt::format(
        "the filling of {} edges around ({:.6g}, {:.6g}, {:.6g}) crosses the mesh or itself: {} pairs of triangles",
        hole.size(), middle[0], middle[1], middle[2], crossings));
  }

  MeshView view_;
  const FillHolesOptions& options_;
  Context& context_;
  Report& report_;
  std::vector<Hole> holes_;                         ///< with their islands
  std::vector<std::vector<HalfedgeHandle>> loops_;  ///< of the holes, without islands
  std::vector<char> is_part_;                       ///< of a loop that meets itself
  std::vector<std::vector<HalfedgeHandle>> islands_;
  std::vector<const char*> island_reasons_;           ///< why it stays open if it is in no hole
  std::vector<std::vector<std::size_t>> islands_of_;  ///< by hole
};

}  // namespace

Report fill_holes(MeshView view, const FillHolesOptions& options, Context& context) {
  validate(options);
  context.checkpoint();
  Report report;
  report.operation = "fill-holes";
  HoleFiller(view, options, context, report).run();
  return report;
}

}  // namespace tri
