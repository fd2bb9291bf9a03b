#include "libtri/triangulation/triangulate.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libtri/model/cad_topology.hpp"
#include "libtri/quiet_context.hpp"
#include "libtri/registration.hpp"
#include "libtri/triangulation/bridges.hpp"
#include "libtri/triangulation/coverage.hpp"
#include "libtri/triangulation/patches.hpp"
#include "libtri/triangulation/point_classes.hpp"
#include "libtri/triangulation/point_mesh.hpp"
#include "libtri/triangulation/point_order.hpp"
#include "libtri/triangulation/shell/connect.hpp"
#include "libtri/triangulation/triangulation_checks.hpp"
#include "libtri/triangulation/untangle.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/crossings/self_intersections.hpp"
#include "meshops/error.hpp"
#include "meshops/pace.hpp"
#include "meshops/select_indices.hpp"

namespace tri {
namespace {

/// Chord height of the tessellation as a share of the diagonal; the result hardly depends on it.
constexpr double deflection_share = 1e-3;
constexpr double deflection_angle = 0.35;  // radians
constexpr double farthest_share = 0.05;    // of the diagonal: beyond it the points do not belong to the model

constexpr double few_defects = 1e-4;  // folded edges and turned triangles per triangle, for `patches` to stand without
                                      // a contest

constexpr double few_bridges = 1e-3;  // of the area, for the same
constexpr double noise_floor = 1e-5;  // of the diagonal: no closer does a triangle bridge

/// Notes the time of each step of a triangulation.
class Stopwatch {
 public:
  explicit Stopwatch(TriangulateResult& result) : result_(result) {}
  void lap(const char* step) {
    const auto now = std::chrono::steady_clock::now();
    result_.seconds.emplace_back(step, std::chrono::duration<double>(now - start_).count());
    start_ = now;
  }

 private:
  TriangulateResult& result_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void validate(std::span<const Vec3> points, const TriangulateOptions& options) {
  if (!(options.hole_size > 0)) throw InvalidInput(fmt::format("hole-size is {}, must be above 0", options.hole_size));
  if (options.outlier_distance && !(*options.outlier_distance > 0))
    throw InvalidInput(fmt::format("outlier-distance is {}, must be above 0", *options.outlier_distance));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::isfinite(points[i][0]) || !std::isfinite(points[i][1]) || !std::isfinite(points[i][2]))
      throw InvalidInput(fmt::format("point {} has a coordinate that is not finite", i));
}

void check_distance(double sigma, double diagonal) {
  const double usual = sigma / 1.4826;
  if (usual <= farthest_share * diagonal) return;
  throw InvalidInput(
      fmt::format("the points do not lie on the model: their median distance is {:.6g} mm, the model's diagonal {:.6g} "
                  "mm; check the "
                  "units and the alignment of the points",
                  usual, diagonal));
}

/// Leaves a point out of everything that follows.
void leave_out(std::vector<Foot>& feet, std::span<const std::uint32_t> indices) {
  for (std::uint32_t i : indices) feet[i].face = -1;
}

/// What the vertices of a mesh know of their points.
struct VertexValues {
  std::vector<int> point_index, cad_face;
  std::vector<Vec2> uv;
  std::vector<double> deviation;

  VertexValues(const CadModel& model, std::span<const Foot> feet, std::span<const std::uint32_t> points)
      : point_index(points.size()), cad_face(points.size()), uv(points.size()), deviation(points.size()) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
      for (std::size_t v = range.begin(); v < range.end(); ++v) {
        const Foot& foot = feet[points[v]];
        point_index[v] = static_cast<int>(points[v]);
        cad_face[v] = model.faces[foot.face].index;
        uv[v] = foot.uv;
        deviation[v] = foot.deviation;
      }
    });
  }
  void copy(std::uint32_t v) {
    point_index.push_back(point_index[v]);
    cad_face.push_back(cad_face[v]);
    uv.push_back(uv[v]);
    deviation.push_back(deviation[v]);
  }
  void move_to(Mesh& mesh) {
    move_to(mesh, property::point_index, point_index);
    move_to(mesh, property::cad_face, cad_face);
    move_to(mesh, property::uv, uv);
    move_to(mesh, property::deviation, deviation);
  }

 private:
  template <class T>
  static void move_to(Mesh& mesh, const char* name, std::vector<T>& values) {
    OpenMesh::VPropHandleT<T> handle;
    mesh.add_property(handle, name);
    mesh.property(handle).data_vector().swap(values);
  }
};

/// Makes the mesh and uses `connected` up, and `feet` if they are not needed any more, since at this step memory is
/// highest.
void to_mesh(const CadModel& model, std::span<const Vec3> points, std::vector<Foot>& feet, bool last,
             PointMesh connected, Mesh& mesh, Context& context) {
  Pace pace(context);
  std::vector<std::uint8_t> used(points.size(), 0);
  for (const Triangle& t : connected.triangles) {
    pace();
    for (std::uint32_t p : t) used[p] = 1;
  }
  const std::vector<std::uint32_t> point_of =
      select_indices(points.size(), [&](std::uint32_t p) { return used[p] != 0; });
  VertexValues values(model, feet, point_of);
  if (last) std::vector<Foot>().swap(feet);
  context.checkpoint();
  std::vector<Vec3> positions;
  if (point_of.size() < points.size()) {
    std::vector<std::uint32_t> vertex_of(points.size());
    positions.reserve(point_of.size());
    for (const std::uint32_t p : point_of) {
      vertex_of[p] = static_cast<std::uint32_t>(positions.size());
      positions.push_back(points[p]);
    }
    for (Triangle& t : connected.triangles)
      for (std::uint32_t& p : t) p = vertex_of[p];
    points = positions;
  }
  for (const std::uint32_t copied : build_mesh_into(mesh, points, connected.triangles, connected.neighbors, context))
    values.copy(copied);
  values.move_to(mesh);
}

void describe_coverage(const CadModel& model, std::span<const Foot> feet, TriangulateResult& result) {
  for (const CadFace& face : model.faces) result.faces.push_back({face.index, face.name, 0, face.area, {}});
  for (const Foot& foot : feet)
    if (foot.face >= 0) ++result.faces[foot.face].points;
  for (const FaceCoverage& face : result.faces)
    if (face.points == 0) result.unmeasured_faces.push_back(face.face);
}

/// The registered points and what they were measured on.
struct Measured {
  const CadModel& model;
  const Registration& registration;
  std::span<const Vec3> points;
  std::span<const Foot> feet;
  double sigma = 0;  ///< mm, of the noise
};

/// What one method made of the points, and what the checks say of it.
struct Candidate {
  Method method = Method::shell;
  PointMesh mesh;
  PointMesh patches;
  TriangulationChecks checks;
  std::vector<std::string> notes;
  std::vector<Report> steps;

  bool right_topology() const { return checks.mesh == checks.model && checks.unused_points == 0; }
  /// Nothing crosses, and folds are so few that another method is not worth its time.
  bool clean() const {
    return right_topology() && checks.self_intersections == 0 &&
           static_cast<double>(checks.folds + checks.turned) <=
               few_defects * static_cast<double>(mesh.triangles.size()) &&
           checks.bridging_share <= few_bridges;
  }
  /// Share of the mesh that is wrong: area that bridges, triangles that cross, and least of all edges that are folded,
  /// which noise does too.
  double defects() const {
    const double count = 4 * static_cast<double>(checks.self_intersections) + static_cast<double>(checks.turned) +
                         0.25 * static_cast<double>(checks.folds);
    return checks.bridging_share + count / static_cast<double>(std::max<std::size_t>(1, mesh.triangles.size()));
  }
  bool better_than(const Candidate& other) const {
    if (checks.unused_points != other.checks.unused_points) return checks.unused_points < other.checks.unused_points;
    if (right_topology() != other.right_topology()) return right_topology();
    return defects() < other.defects();
  }
};

/// Undoes what bridges and crossings can be undone, then checks.
void finish(Candidate& candidate, const Measured& measured, const SurfaceTopology& model, Context& context) {
  const double tolerance = 3 * measured.sigma + noise_floor * measured.model.diagonal;
  const Bridges bridges =
      lessen_bridges(measured.points, measured.feet, measured.registration, tolerance, candidate.mesh, context);
  auto crossings = untangle(measured.points, measured.feet, candidate.mesh, context);
  if (mend_crossings(measured.points, measured.feet, measured.registration, tolerance, crossings, candidate.mesh,
                     context))
    crossings = self_intersections(measured.points, candidate.mesh.triangles, context);
  context.checkpoint();
  SurfaceTopology found;
  tbb::parallel_invoke(
      [&] { found = topology(candidate.mesh.triangles, candidate.mesh.neighbors, &context); },
      [&] { candidate.checks = check_triangulation(measured.points, measured.feet, candidate.mesh, &context); });
  candidate.checks.bridging = bridges.triangles;
  candidate.checks.bridging_share = bridges.share();
  candidate.checks.self_intersections = crossings.size();
  candidate.checks.model = model;
  candidate.checks.mesh = found;
}

Candidate by_patches(const Measured& measured, bool keep_patches, Stopwatch& watch, Context& context) {
  const CadModel& model = measured.model;
  PatchConnection connection =
      connect_by_patches(model, measured.feet, measured.points, {.keep_patches = keep_patches}, context);
  watch.lap("connect by patches");
  Candidate candidate{Method::patches,
                      std::move(connection.mesh),
                      std::move(connection.patches),
                      {},
                      {},
                      std::move(connection.reports)};
  const CadTopology cad = cad_topology(model);
  finish(candidate, measured, {cad.components, cad.loops, cad.euler}, context);
  watch.lap("untangle and check patches");
  for (const int f : connection.failed_faces)
    candidate.notes.push_back(fmt::format(
        "face {} could not be triangulated by itself: its trimming loops cross or touch", model.faces[f].index));
  if (connection.open_stars > 0)
    candidate.notes.push_back(
        fmt::format("{} places have too few points around them to keep the model's topology and were left open",
                    connection.open_stars));
  return candidate;
}

Candidate by_shell(const Measured& measured, Stopwatch& watch, Context& context) {
  const CadModel& model = measured.model;
  const Tessellation tessellation = tessellate(model, deflection_share * model.diagonal, deflection_angle, context);
  watch.lap("tessellate model");
  ShellConnection shell = connect_by_shell(model, tessellation, measured.feet, context);
  watch.lap("connect by shell");
  Candidate candidate{Method::shell, std::move(shell.mesh), {}, {}, {}, {}};
  finish(candidate, measured, topology(tessellation.triangles, tessellation.neighbors), context);
  watch.lap("untangle and check shell");
  if (shell.lost_shells > 0)
    candidate.notes.push_back(
        fmt::format("{} connected parts of the model got no point and are not in the mesh", shell.lost_shells));
  if (shell.open_stars > 0)
    candidate.notes.push_back(fmt::format(
        "{} places have too few points around them to keep the model's topology and were left open", shell.open_stars));
  return candidate;
}

/// What is wrong with a candidate, in words.
std::string describe_candidate(const Candidate& candidate) {
  const TriangulationChecks& c = candidate.checks;
  return fmt::format(
      "{} topology, {} self-intersections, {} folds, {} turned triangles, {:.2g}% of the area bridges, {} unused points",
      c.mesh == c.model ? "exact" : "wrong", c.self_intersections, c.folds, c.turned, 100 * c.bridging_share,
      c.unused_points);
}

/// Runs the method asked for. Automatic runs `patches`, which is the faster, and `shell` only if `patches` is not
/// clean.
Candidate connect(const Measured& measured, const TriangulateOptions& options, Stopwatch& watch, std::string& reason,
                  Context& context) {
  Candidate patches;
  if (options.method != Method::shell || options.keep_patches) {
    patches = by_patches(measured, options.keep_patches, watch, context);
    if (options.method == Method::patches) {
      reason = "asked for";
      return patches;
    }
  }
  if (options.method == Method::automatic && patches.clean()) {
    reason = fmt::format("the checks find next to nothing wrong: {}", describe_candidate(patches));
    return patches;
  }
  Candidate shell = by_shell(measured, watch, context);
  if (options.method == Method::automatic) {
    const bool take_shell = shell.better_than(patches);
    reason = fmt::format("the better of patches ({}) and shell ({})", describe_candidate(patches),
                         describe_candidate(shell));
    if (!take_shell) return patches;
  } else {
    reason = "asked for";
  }
  shell.patches = std::move(patches.patches);
  return shell;
}

void note_checks(const Candidate& candidate, TriangulateResult& result) {
  const TriangulationChecks& c = candidate.checks;
  const auto text = [](const SurfaceTopology& t) {
    return fmt::format("{} / {} / {}", t.components, t.loops, t.euler);
  };
  if (!(c.mesh == c.model))
    result.notes.push_back(fmt::format(
        "topology differs from the model's: components / boundary loops / Euler characteristic are {}, the model's {}",
        text(c.mesh), text(c.model)));
  result.notes.insert(result.notes.end(), candidate.notes.begin(), candidate.notes.end());
  if (c.self_intersections > 0)
    result.notes.push_back(fmt::format("{} pairs of triangles cross each other", c.self_intersections));
  if (c.folds > 0) result.notes.push_back(fmt::format("{} edges are folded by more than 150 degrees", c.folds));
  if (c.turned > 0) result.notes.push_back(fmt::format("{} triangles face against the model", c.turned));
  if (c.bridging_share > few_bridges)
    result.notes.push_back(
        fmt::format("{} triangles, {:.2g}% of the area, stand across the model where its faces got too few "
                    "points",
                    c.bridging, 100 * c.bridging_share));
  if (c.unused_points > 0) result.notes.push_back(fmt::format("{} points could not be connected", c.unused_points));
}

void triangulate_sorted(const CadModel& model, const Registration& registration, std::span<const Vec3> points,
                        const TriangulateOptions& options, TriangulateResult& result, Stopwatch& watch,
                        Context& context) {
  std::vector<Foot> feet = registration.register_points(points, context);
  watch.lap("register");

  result.duplicates = find_duplicates(points, &context);
  leave_out(feet, result.duplicates);
  if (points.size() - result.duplicates.size() < 3)
    throw InvalidInput(
        fmt::format("{} distinct points are too few: three make a triangle", points.size() - result.duplicates.size()));
  context.checkpoint();
  result.sigma = robust_sigma(feet);
  context.checkpoint();
  check_distance(result.sigma, model.diagonal);
  result.outliers = find_outliers(feet, model.diagonal, options.outlier_distance, result.sigma);
  leave_out(feet, result.outliers);
  context.checkpoint();
  describe_coverage(model, feet, result);
  watch.lap("classify points");

  Candidate best =
      connect({model, registration, points, feet, result.sigma}, options, watch, result.method_reason, context);
  result.method = best.method;
  result.checks = best.checks;
  result.steps = std::move(best.steps);
  for (FaceCoverage& face : result.faces) face.method = best.method == Method::shell ? "shell" : "patches";

  if (options.unmeasured == Unmeasured::hole) {
    Coverage coverage = find_unmeasured(model, registration, best.mesh, feet, options.hole_size, context);
    drop_triangles(best.mesh, coverage.open_triangles);
    result.holes = std::move(coverage.regions);
  }
  watch.lap("unmeasured regions");
  context.checkpoint();

  to_mesh(model, points, feet, !options.keep_patches, std::move(best.mesh), result.mesh, context);
  if (options.keep_patches)
    to_mesh(model, points, feet, true, std::move(best.patches), result.patches.emplace(), context);
  note_checks(best, result);
  watch.lap("build mesh");
}

/// Turns indices into the sorted points into indices into the points as given.
void name_points_as_given(TriangulateResult& result, std::span<const std::uint32_t> order) {
  for (auto* indices : {&result.outliers, &result.duplicates}) {
    for (std::uint32_t& i : *indices) i = order[i];
    std::sort(indices->begin(), indices->end());
  }
  for (Mesh* mesh : {&result.mesh, result.patches ? &*result.patches : nullptr}) {
    OpenMesh::VPropHandleT<int> point_index;
    if (!mesh || !mesh->get_property_handle(point_index, property::point_index)) continue;
    auto& indices = mesh->property(point_index).data_vector();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, indices.size(), 4096), [&](const auto& range) {
      for (std::size_t v = range.begin(); v < range.end(); ++v)
        indices[v] = static_cast<int>(order[static_cast<std::size_t>(indices[v])]);
    });
  }
}

}  // namespace

TriangulateResult triangulate(const CadModel& model, std::span<const Vec3> points, const TriangulateOptions& options,
                              Context& context) {
  validate(points, options);
  TriangulateResult made;
  Stopwatch watch(made);
  const Registration registration(model, context);
  watch.lap("index model");
  TriangulateResult result = triangulate(model, registration, points, options, context);
  result.seconds.insert(result.seconds.begin(), made.seconds.begin(), made.seconds.end());
  return result;
}

TriangulateResult triangulate(const CadModel& model, const Registration& registration, std::span<const Vec3> points,
                              const TriangulateOptions& options, Context& context) {
  validate(points, options);
  TriangulateResult result;
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(context.threads > 0 ? std::min(context.threads, cores) : cores);
  arena.execute([&] {
    Stopwatch watch(result);
    // Unordered points are put in the order of a space-filling curve once: every later step then finds neighbours in
    // space near each other in memory. Equal points keep their order, so the earliest of them still counts.
    const std::vector<std::uint32_t> order = registration.order_of(points);
    context.checkpoint();
    std::vector<Vec3> sorted(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) sorted[i] = points[order[i]];
    });
    watch.lap("sort points");
    context.checkpoint();
    ForwardContext forward(context);  // steps are taken again for what is found on the way
    triangulate_sorted(model, registration, sorted, options, result, watch, forward);
    name_points_as_given(result, order);
  });
  return result;
}

}  // namespace tri
