#include "libtri/patches.hpp"

#include <fmt/core.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "libtri/patches/boundary_index.hpp"
#include "libtri/patches/face_patch.hpp"
#include "libtri/patches/glue.hpp"
#include "libtri/shell/delaunay_flips.hpp"
#include "libtri/shell/vertex_removal.hpp"
#include "meshops/build_mesh.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr int largest_level = 6;  // chains are halved at most so often where loops touch
constexpr int largest_rounds = 12;

class Clock {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct EdgeState {
  std::vector<std::pair<const CoedgeCurve*, int>> uses;  // and the face
  double spacing = 0, reach = 0;                         // mm
  int level = 0;
  std::vector<ChainNode> measured;
};

// Steps (c) and (d): from feet to a mesh with the topology of the model, of points and auxiliary vertices.
class Assembler {
 public:
  Assembler(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points, const PatchesOptions& options,
            const Context& context, PatchesResult& result)
      : model_(model), feet_(feet), points_(points), options_(options), context_(context), result_(result) {}

  EditMesh run() {
    sort_by_face();
    domains_.resize(model_.faces.size());
    tbb::parallel_for(std::size_t{0}, domains_.size(), [&](std::size_t f) { domains_[f] = face_domain(model_.faces[f]); });
    prepare_edges();
    place_points();
    for (std::size_t e = 0; e < edges_.size(); ++e) build_chain(e);
    triangulate();
    return assemble();
  }

  std::size_t n_auxiliary() const { return auxiliary_.size(); }
  /// Whether an auxiliary vertex lies on an edge between two faces or a free edge, rather than inside a face or on its seam.
  bool on_contour(std::size_t auxiliary) const { return contour_[auxiliary]; }

 private:
  std::size_t n_faces() const { return model_.faces.size(); }

  void sort_by_face() {
    start_.assign(n_faces() + 1, 0);
    for (const Foot& foot : feet_)
      if (foot.face >= 0) ++start_[static_cast<std::size_t>(foot.face) + 1];
    for (std::size_t f = 0; f < n_faces(); ++f) start_[f + 1] += start_[f];
    by_face_.resize(start_.back());
    std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < feet_.size(); ++i)
      if (feet_[i].face >= 0) by_face_[next[static_cast<std::size_t>(feet_[i].face)]++] = static_cast<std::uint32_t>(i);
  }

  void prepare_edges() {
    double area = 0;
    for (const CadFace& face : model_.faces) area += face.area;
    const double overall = std::sqrt(area / static_cast<double>(std::max<std::size_t>(by_face_.size(), 1)));
    edges_.resize(model_.edges.size());
    for (std::size_t f = 0; f < n_faces(); ++f)
      for (const auto& loop : domains_[f].loops)
        for (const CoedgeCurve& curve : loop) edges_[static_cast<std::size_t>(curve.edge())].uses.emplace_back(&curve, static_cast<int>(f));
    for (EdgeState& edge : edges_) {
      double spacing = std::numeric_limits<double>::infinity();
      for (const auto& [curve, f] : edge.uses) {
        const std::size_t n = start_[static_cast<std::size_t>(f) + 1] - start_[static_cast<std::size_t>(f)];
        const double own = n >= 4 ? std::sqrt(model_.faces[static_cast<std::size_t>(f)].area / static_cast<double>(n)) : overall;
        spacing = std::min(spacing, own);
      }
      edge.spacing = spacing;
      edge.reach = options_.edge_reach * spacing;
    }
    corner_.assign(model_.vertices.size(), 0);
    chains_.resize(edges_.size());
  }

  std::uint32_t add_auxiliary(const Vec3& p, bool contour) {
    auxiliary_.push_back(p);
    contour_.push_back(contour);
    return static_cast<std::uint32_t>(points_.size() + auxiliary_.size() - 1);
  }

  // Points close to an edge become nodes of its chain, the others stay inside their face.
  void place_points() {
    std::vector<double> reach;
    for (const EdgeState& e : edges_) reach.push_back(e.reach);
    indices_.resize(n_faces());
    inside_.resize(n_faces());
    std::vector<std::vector<std::pair<int, ChainNode>>> snapped(n_faces());
    tbb::parallel_for(std::size_t{0}, n_faces(), [&](std::size_t f) {
      indices_[f] = std::make_unique<BoundaryIndex>(domains_[f], reach);
      inside_[f].reserve(start_[f + 1] - start_[f]);
      for (std::size_t k = start_[f]; k < start_[f + 1]; ++k) {
        const std::uint32_t i = by_face_[k];
        const Vec2 p = domains_[f].to_plane(feet_[i].uv);
        const auto place = indices_[f]->close(p);
        if (place.edge >= 0 && !model_.edges[static_cast<std::size_t>(place.edge)].degenerate) {
          snapped[f].push_back({place.edge, {place.s, i}});
        } else {
          inside_[f].push_back({p, i});
        }
      }
    });
    for (std::size_t f = 0; f < n_faces(); ++f) {
      for (const auto& [edge, node] : snapped[f]) edges_[static_cast<std::size_t>(edge)].measured.push_back(node);
      add_inner_vertices(f);
    }
  }

  // A face that closes on itself needs vertices all around, or triangles would reach around it from both sides of the seam.
  void add_inner_vertices(std::size_t f) {
    bool closed = false;
    for (const auto& loop : domains_[f].loops)
      for (const CoedgeCurve& curve : loop) {
        const auto& uses = edges_[static_cast<std::size_t>(curve.edge())].uses;
        closed |= model_.edges[static_cast<std::size_t>(curve.edge())].degenerate || (uses.size() == 2 && uses[0].second == uses[1].second);
      }
    if (!closed) return;
    const CadFace& face = model_.faces[f];
    const FaceDomain& domain = domains_[f];
    constexpr int around = 6;
    const Vec2 size = domain.to_plane({face.u_max - face.u_min, face.v_max - face.v_min});
    const auto count = [&](int k) { return std::clamp(static_cast<int>(around * size[k] / std::max(size[1 - k], 1e-300)), around, 64); };
    const int nu = count(0), nv = count(1);
    for (int i = 0; i < nu; ++i)
      for (int j = 0; j < nv; ++j) {
        const Vec2 uv(face.u_min + (face.u_max - face.u_min) * (i + 0.5 + 0.1 * (j % 2)) / nu,
                      face.v_min + (face.v_max - face.v_min) * (j + 0.5) / nv);
        const Vec2 p = domain.to_plane(uv);
        if (indices_[f]->close(p).edge >= 0) continue;
        inside_[f].push_back({p, add_auxiliary(face.surface->point(uv[0], uv[1]), false)});
      }
  }

  std::uint32_t corner(int vertex, const Vec3& p) {
    if (vertex < 0) return add_auxiliary(p, true);
    std::uint32_t& id = corner_[static_cast<std::size_t>(vertex)];
    if (id == 0) id = add_auxiliary(p, true) + 1;
    return id - 1;
  }

  void build_chain(std::size_t e) {
    EdgeState& edge = edges_[e];
    EdgeChain& chain = chains_[e];
    chain.clear();
    if (edge.uses.empty()) return;
    const CadEdge& cad = model_.edges[e];
    const CoedgeCurve& curve = *edge.uses[0].first;
    const std::uint32_t first = corner(cad.start_vertex, curve.space_point(0));
    const bool closed = cad.degenerate || (cad.start_vertex == cad.end_vertex && (curve.space_point(0) - curve.space_point(1)).norm() <=
                                                                                      1e-3 * curve.length());
    const std::uint32_t last = closed ? first : corner(cad.end_vertex, curve.space_point(1));
    const bool seam = edge.uses.size() == 2 && edge.uses[0].second == edge.uses[1].second;

    auto& nodes = edge.measured;
    std::sort(nodes.begin(), nodes.end(), [](const ChainNode& a, const ChainNode& b) { return a.s != b.s ? a.s < b.s : a.vertex < b.vertex; });
    separate(nodes);

    chain.push_back({0, first});
    const auto divide = [&](auto&& self, double s0, double s1, int depth) -> void {
      const double scale = std::ldexp(1.0, -edge.level);
      bool split = depth < 2 - (nodes.empty() ? 0 : 1);
      split |= (s1 - s0) * curve.length() > options_.edge_spacing * edge.spacing * scale * 1.5;
      for (const auto& use : edge.uses) split |= use.first->sagitta(s0, s1) > 0.5 * edge.reach * scale;
      if (!split || depth > 24) return;
      const double middle = 0.5 * (s0 + s1);
      self(self, s0, middle, depth + 1);
      // A pole stays one vertex, however many nodes its curve in the plane has.
      chain.push_back({middle, cad.degenerate ? first : add_auxiliary(curve.space_point(middle), !seam)});
      self(self, middle, s1, depth + 1);
    };
    double before = 0;
    for (const ChainNode& node : nodes) {
      if (cad.degenerate) continue;
      divide(divide, before, node.s, 1);
      chain.push_back(node);
      before = node.s;
    }
    divide(divide, before, 1, nodes.empty() ? 0 : 1);
    chain.push_back({1, last});
  }

  // Nodes at one place are set apart along the edge; of points at one position only the first stays.
  void separate(std::vector<ChainNode>& nodes) {
    constexpr double step = 1e-7;
    std::vector<ChainNode> apart;
    for (ChainNode node : nodes) {
      bool duplicate = false;
      for (std::size_t k = apart.size(); k-- > 0 && apart[k].s > node.s - 1e-4;)
        if (points_[apart[k].vertex] == points_[node.vertex]) {
          result_.duplicates.push_back({node.vertex, apart[k].vertex});
          duplicate = true;
          break;
        }
      if (duplicate) continue;
      node.s = std::max(node.s, apart.empty() ? step : apart.back().s + step);
      apart.push_back(node);
    }
    double limit = 1 - step;
    for (std::size_t k = apart.size(); k-- > 0;) {
      apart[k].s = std::min(apart[k].s, limit);
      limit = apart[k].s - step;
    }
    nodes = std::move(apart);
  }

  void triangulate() {
    patches_.resize(n_faces());
    std::vector<std::uint8_t> dirty(n_faces(), 1);
    for (int round = 0; round < largest_rounds; ++round) {
      context_.checkpoint();
      tbb::parallel_for(std::size_t{0}, n_faces(), [&](std::size_t f) {
        if (dirty[f]) patches_[f] = triangulate_face(domains_[f], chains_, inside_[f], context_);
      });
      std::vector<std::uint8_t> changed(edges_.size(), 0), again(n_faces(), 0);
      for (std::size_t f = 0; f < n_faces(); ++f)
        if (dirty[f]) revise(f, changed, again);
      for (std::size_t e = 0; e < edges_.size(); ++e) {
        if (!changed[e]) continue;
        build_chain(e);
        for (const auto& use : edges_[e].uses) again[static_cast<std::size_t>(use.second)] = 1;
      }
      dirty = again;
      if (std::find(dirty.begin(), dirty.end(), 1) == dirty.end()) return;
    }
  }

  void revise(std::size_t f, std::vector<std::uint8_t>& changed, std::vector<std::uint8_t>& again) {
    FacePatch& patch = patches_[f];
    for (const auto& [vertex, kept] : patch.coincident) {
      auto& list = inside_[f];
      const auto at = std::find_if(list.begin(), list.end(), [v = vertex](const PlanePoint& p) { return p.vertex == v; });
      if (at == list.end()) continue;
      if (vertex >= points_.size()) {
        list.erase(at);
      } else if (kept < points_.size() && points_[vertex] == points_[kept]) {
        result_.duplicates.push_back({vertex, kept});
        list.erase(at);
      } else {
        // Two points over one foot: set apart by a hair, each in its own direction.
        const double angle = 2.399963 * static_cast<double>(vertex % 1000);
        const double hair = 1e-5 * std::sqrt(model_.faces[f].area / static_cast<double>(list.size()));
        at->p += Vec2(std::cos(angle), std::sin(angle)) * hair;
        again[f] = 1;
      }
    }
    for (const std::uint32_t vertex : patch.outside) {
      auto& list = inside_[f];
      const auto at = std::find_if(list.begin(), list.end(), [vertex](const PlanePoint& p) { return p.vertex == vertex; });
      if (at == list.end()) continue;
      if (vertex < points_.size()) {
        const auto place = indices_[f]->closest(at->p);
        if (place.edge < 0 || model_.edges[static_cast<std::size_t>(place.edge)].degenerate) continue;
        edges_[static_cast<std::size_t>(place.edge)].measured.push_back({place.s, vertex});
        changed[static_cast<std::size_t>(place.edge)] = 1;
      } else {
        again[f] = patch.triangles.empty() ? 1 : again[f];
      }
      list.erase(at);
    }
    for (const int e : patch.failed_edges) {
      if (edges_[static_cast<std::size_t>(e)].level >= largest_level) continue;
      ++edges_[static_cast<std::size_t>(e)].level;
      changed[static_cast<std::size_t>(e)] = 1;
    }
  }

  EditMesh assemble() {
    std::vector<EditMesh::Vertex> vertices(points_.size() + auxiliary_.size());
    std::vector<std::uint8_t> on_chain(vertices.size(), 0);
    for (std::size_t i = 0; i < points_.size(); ++i) vertices[i] = {feet_[i].point, feet_[i].normal, 0, static_cast<std::int32_t>(i)};
    for (std::size_t k = 0; k < auxiliary_.size(); ++k) vertices[points_.size() + k].p = auxiliary_[k];
    std::vector<std::size_t> sizes;
    for (const EdgeChain& chain : chains_) {
      sizes.push_back(chain.size());
      for (const ChainNode& node : chain) on_chain[node.vertex] = 1;
    }
    for (std::size_t f = 0; f < n_faces(); ++f)
      if (patches_[f].triangles.empty()) result_.failed_faces.push_back(static_cast<int>(f));
    return glue_patches(model_, patches_, sizes, std::move(vertices), on_chain);
  }

  const CadModel& model_;
  std::span<const Foot> feet_;
  std::span<const Vec3> points_;
  const PatchesOptions& options_;
  const Context& context_;
  PatchesResult& result_;

  std::vector<std::uint32_t> start_, by_face_;
  std::vector<FaceDomain> domains_;
  std::vector<std::unique_ptr<BoundaryIndex>> indices_;
  std::vector<EdgeState> edges_;
  std::vector<EdgeChain> chains_;
  std::vector<std::vector<PlanePoint>> inside_;
  std::vector<FacePatch> patches_;
  std::vector<Vec3> auxiliary_;
  std::vector<std::uint8_t> contour_;
  std::vector<std::uint32_t> corner_;  // per model vertex: its mesh vertex + 1; 0 if it has none yet
};

// The half-edge mesh of the triangles whose corners are all points, with positions and properties.
Mesh to_mesh(const EditMesh& mesh, const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points, bool one_face,
             Context& context) {
  std::vector<std::int32_t> number(mesh.vertices.size(), -1), triangle_number(mesh.triangles.size(), -1);
  std::int32_t n_triangles = 0;
  const auto taken = [&](const Triangle& t) {
    for (const std::uint32_t v : t)
      if (mesh.vertices[v].point < 0) return false;
    const auto face = [&](int k) { return feet[static_cast<std::size_t>(mesh.vertices[t[k]].point)].face; };
    return !one_face || (face(0) == face(1) && face(0) == face(2));
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!mesh.alive(static_cast<std::int32_t>(t)) || !taken(mesh.triangles[t])) continue;
    triangle_number[t] = n_triangles++;
    for (const std::uint32_t v : mesh.triangles[t]) number[v] = 0;
  }
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> index;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<std::int32_t>(index.size());
    index.push_back(static_cast<std::uint32_t>(mesh.vertices[v].point));
    positions.push_back(points[index.back()]);
  }
  std::vector<Triangle> triangles(static_cast<std::size_t>(n_triangles));
  std::vector<std::array<std::int32_t, 3>> neighbors(triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (triangle_number[t] < 0) continue;
    const auto to = static_cast<std::size_t>(triangle_number[t]);
    for (int k = 0; k < 3; ++k) {
      triangles[to][k] = static_cast<std::uint32_t>(number[mesh.triangles[t][k]]);
      const std::int32_t n = mesh.neighbors[t][k];
      neighbors[to][k] = n < 0 ? -1 : triangle_number[static_cast<std::size_t>(n)];
    }
  }
  BuiltMesh built = build_mesh(positions, triangles, neighbors, context);
  Mesh& out = built.mesh;
  OpenMesh::VPropHandleT<int> point_index, cad_face;
  OpenMesh::VPropHandleT<Vec2> uv;
  OpenMesh::VPropHandleT<double> deviation;
  out.add_property(point_index, property::point_index);
  out.add_property(cad_face, property::cad_face);
  out.add_property(uv, property::uv);
  out.add_property(deviation, property::deviation);
  for (std::size_t i = 0; i < out.n_vertices(); ++i) {
    const VertexHandle v(static_cast<int>(i));
    const std::uint32_t p = index[built.point_of_vertex[i]];
    out.property(point_index, v) = static_cast<int>(p);
    out.property(cad_face, v) = model.faces[static_cast<std::size_t>(feet[p].face)].index;
    out.property(uv, v) = feet[p].uv;
    out.property(deviation, v) = feet[p].deviation;
  }
  return std::move(out);
}

}  // namespace

PatchesResult triangulate_patches(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points,
                                  const PatchesOptions& options, Context& context) {
  if (feet.size() != points.size())
    throw InvalidInput(fmt::format("triangulate_patches: {} feet for {} points", feet.size(), points.size()));
  if (!(options.edge_reach > 0) || !(options.edge_spacing > 0))
    throw InvalidInput("triangulate_patches: edge_reach and edge_spacing must be positive");
  PatchesResult result;
  Clock clock;
  const auto step = [&](const char* name) -> Report& {
    Report& report = result.reports.emplace_back();
    report.operation = name;
    report.seconds = clock.lap();
    context.checkpoint();
    return report;
  };
  context.progress("patches", 0);

  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  std::optional<Assembler> assembler;
  EditMesh mesh;
  arena.execute([&] {
    assembler.emplace(model, feet, points, options, context, result);
    mesh = assembler->run();
  });
  {
    Report& report = step("delaunay");
    report.faces_added = mesh.triangles.size();
    report.figures["auxiliary vertices"] = static_cast<double>(assembler->n_auxiliary());
    report.figures["failed faces"] = static_cast<double>(result.failed_faces.size());
    report.figures["duplicates"] = static_cast<double>(result.duplicates.size());
    for (const int f : result.failed_faces)
      report.notes.push_back(fmt::format("face {} could not be triangulated: its trimming loops cross or touch", model.faces[static_cast<std::size_t>(f)].index));
  }

  // Seams and poles first: contour vertices count as points for that long.
  constexpr std::int32_t pinned = std::numeric_limits<std::int32_t>::max();
  for (std::size_t k = 0; k < assembler->n_auxiliary(); ++k)
    if (assembler->on_contour(k)) mesh.vertices[points.size() + k].point = pinned;
  measure_vertex_areas(mesh);
  Context quiet;
  const VertexRemoval seams = remove_model_vertices(mesh, quiet);
  for (EditMesh::Vertex& v : mesh.vertices)
    if (v.point == pinned) v.point = -1;
  {
    Report& report = step("close-seams");
    report.vertices_removed = seams.removed;
    if (seams.kept > 0) report.skipped["removal would change the topology"] = seams.kept;
  }
  if (options.keep_patches) {
    result.patches = to_mesh(mesh, model, feet, points, true, context);
    step("patches").faces_added = result.patches.n_faces();
  }
  context.progress("patches", 0.5);

  const VertexRemoval stitched = remove_model_vertices(mesh, quiet);
  {
    Report& report = step("stitch-patches");
    report.vertices_removed = stitched.removed;
    if (stitched.kept > 0) report.skipped["removal would change the topology"] = stitched.kept;
  }
  step("flip-diagonals").edges_flipped = delaunay_flips(mesh, {});
  context.progress("patches", 0.8);

  result.mesh = to_mesh(mesh, model, feet, points, false, context);
  step("lift").vertices_added = result.mesh.n_vertices();

  std::vector<std::uint8_t> known(points.size(), 0);
  for (const auto& pair : result.duplicates) known[pair[0]] = 1;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!known[i] && feet[i].face >= 0 && mesh.vertex_triangle[i] < 0) result.unused_points.push_back(static_cast<std::uint32_t>(i));
  std::sort(result.duplicates.begin(), result.duplicates.end());
  context.progress("patches", 1);
  return result;
}

}  // namespace tri
