#include "libtri/triangulation/patches/assemble.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "libtri/triangulation/patches/boundary_index.hpp"
#include "libtri/triangulation/patches/face_patch.hpp"
#include "libtri/triangulation/patches/glue.hpp"
#include "meshops/pace.hpp"

namespace tri {
namespace {

constexpr int largest_level = 6;  // chains are halved at most so often where loops touch
constexpr int largest_rounds = 12;

struct EdgeState {
  std::vector<std::pair<const CoedgeCurve*, int>> uses;  // and the face
  double spacing = 0, reach = 0;                         // mm
  int level = 0;
  std::vector<ChainNode> measured;
};

class Assembler {
 public:
  Assembler(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points,
            const PatchesOptions& options, const Context& context, AssembledPatches& result)
      : model_(model), feet_(feet), points_(points), options_(options), context_(context), result_(result) {}

  void run() {
    sort_by_face();
    context_.checkpoint();
    domains_.resize(model_.faces.size());
    tbb::parallel_for(std::size_t{0}, domains_.size(),
                      [&](std::size_t f) { domains_[f] = face_domain(model_.faces[f]); });
    prepare_edges();
    context_.checkpoint();
    place_points();
    context_.checkpoint();
    for (std::size_t e = 0; e < edges_.size(); ++e) build_chain(e);
    triangulate();
    context_.checkpoint();
    assemble();
    context_.checkpoint();
  }

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
        for (const CoedgeCurve& curve : loop)
          edges_[static_cast<std::size_t>(curve.edge())].uses.emplace_back(&curve, static_cast<int>(f));
    for (EdgeState& edge : edges_) {
      double spacing = std::numeric_limits<double>::infinity();
      for (const auto& [curve, f] : edge.uses) {
        const std::size_t n = start_[static_cast<std::size_t>(f) + 1] - start_[static_cast<std::size_t>(f)];
        const double own =
            n >= 4 ? std::sqrt(model_.faces[static_cast<std::size_t>(f)].area / static_cast<double>(n)) : overall;
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
    result_.on_contour.push_back(contour);
    return static_cast<std::uint32_t>(points_.size() + auxiliary_.size() - 1);
  }

  // Points close to an edge become nodes of its chain, the others stay inside their face.
  void place_points() {
    for (const EdgeState& e : edges_) reach_.push_back(e.reach);
    indices_.resize(n_faces());
    inside_.resize(n_faces());
    nodes_.resize(n_faces());
    std::vector<std::vector<std::pair<int, ChainNode>>> snapped(n_faces());
    tbb::parallel_for(std::size_t{0}, n_faces(), [&](std::size_t f) {
      indices_[f] = std::make_unique<BoundaryIndex>(domains_[f], reach_);
      inside_[f].reserve(start_[f + 1] - start_[f]);
      Pace pace(context_, 4096);
      for (std::size_t k = start_[f]; k < start_[f + 1]; ++k) {
        pace();
        const std::uint32_t i = by_face_[k];
        const Vec2 p = domains_[f].to_plane(feet_[i].uv);
        const auto place = indices_[f]->close(p);
        if (place.edge >= 0 && !model_.edges[static_cast<std::size_t>(place.edge)].degenerate) {
          snapped[f].push_back({place.edge, {place.s, i}});
          nodes_[f].push_back({p, i});
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

  // A face that closes on itself needs vertices all around, or triangles would reach around it from both sides of the
  // seam.
  void add_inner_vertices(std::size_t f) {
    bool closed = false;
    for (const auto& loop : domains_[f].loops)
      for (const CoedgeCurve& curve : loop) {
        const auto& uses = edges_[static_cast<std::size_t>(curve.edge())].uses;
        closed |= model_.edges[static_cast<std::size_t>(curve.edge())].degenerate ||
                  (uses.size() == 2 && uses[0].second == uses[1].second);
      }
    if (!closed) return;
    const CadFace& face = model_.faces[f];
    const FaceDomain& domain = domains_[f];
    constexpr int around = 6;
    const Vec2 size = domain.to_plane({face.u_max - face.u_min, face.v_max - face.v_min});
    const auto count = [&](int k) {
      return std::clamp(static_cast<int>(around * size[k] / std::max(size[1 - k], 1e-300)), around, 64);
    };
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
    const bool closed =
        cad.degenerate || (cad.start_vertex == cad.end_vertex &&
                           (curve.space_point(0) - curve.space_point(1)).norm() <= 1e-3 * curve.length());
    const std::uint32_t last = closed ? first : corner(cad.end_vertex, curve.space_point(1));
    const bool seam = edge.uses.size() == 2 && edge.uses[0].second == edge.uses[1].second;

    auto& nodes = edge.measured;
    std::sort(nodes.begin(), nodes.end(),
              [](const ChainNode& a, const ChainNode& b) { return a.s != b.s ? a.s < b.s : a.vertex < b.vertex; });
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
    failed_.assign(n_faces(), 0);
    std::vector<std::uint8_t> dirty(n_faces(), 1);
    for (int round = 0; round < largest_rounds; ++round) {
      context_.checkpoint();
      tbb::parallel_for(std::size_t{0}, n_faces(), [&](std::size_t f) {
        if (!dirty[f]) return;
        // A face that failed tries again with nothing but its curves.
        const std::span<const PlanePoint> nodes = failed_[f] ? std::span<const PlanePoint>() : nodes_[f];
        patches_[f] = triangulate_face(domains_[f], chains_, nodes, reach_, inside_[f], context_);
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
      const auto at =
          std::find_if(list.begin(), list.end(), [v = vertex](const PlanePoint& p) { return p.vertex == v; });
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
      const auto at =
          std::find_if(list.begin(), list.end(), [vertex](const PlanePoint& p) { return p.vertex == vertex; });
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
    if (!patch.failed_edges.empty() && !failed_[f]) {
      failed_[f] = 1;
      again[f] = 1;
      return;
    }
    for (const int e : patch.failed_edges) {
      if (edges_[static_cast<std::size_t>(e)].level >= largest_level) continue;
      ++edges_[static_cast<std::size_t>(e)].level;
      changed[static_cast<std::size_t>(e)] = 1;
    }
  }

  void assemble() {
    std::vector<EditMesh::Vertex> vertices(points_.size() + auxiliary_.size());
    std::vector<std::uint8_t> on_chain(vertices.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_.size(), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        vertices[i] = {feet_[i].point, feet_[i].normal, 0, static_cast<std::int32_t>(i)};
    });
    for (std::size_t k = 0; k < auxiliary_.size(); ++k) vertices[points_.size() + k].p = auxiliary_[k];
    std::vector<std::size_t> sizes;
    for (const EdgeChain& chain : chains_) {
      sizes.push_back(chain.size());
      for (const ChainNode& node : chain) on_chain[node.vertex] = 1;
    }
    for (const FaceDomain& domain : domains_) result_.uniform_faces.push_back(domain.uniform);
    for (std::size_t f = 0; f < n_faces(); ++f)
      if (patches_[f].triangles.empty()) result_.failed_faces.push_back(static_cast<int>(f));
    context_.checkpoint();
    if (options_.keep_patches) result_.separate = glue_patches(model_, patches_, sizes, vertices, on_chain, false);
    context_.checkpoint();
    result_.mesh = glue_patches(model_, patches_, sizes, std::move(vertices), on_chain, true);
  }

  const CadModel& model_;
  std::span<const Foot> feet_;
  std::span<const Vec3> points_;
  const PatchesOptions& options_;
  const Context& context_;
  AssembledPatches& result_;

  std::vector<std::uint32_t> start_, by_face_;
  std::vector<FaceDomain> domains_;
  std::vector<std::unique_ptr<BoundaryIndex>> indices_;
  std::vector<EdgeState> edges_;
  std::vector<EdgeChain> chains_;
  std::vector<std::vector<PlanePoint>> inside_, nodes_;  // nodes_: points that went to a chain, by index
  std::vector<double> reach_;
  std::vector<FacePatch> patches_;
  std::vector<std::uint8_t> failed_;  // per face: its loops have crossed or touched before
  std::vector<Vec3> auxiliary_;
  std::vector<std::uint32_t> corner_;  // per model vertex: its mesh vertex + 1; 0 if it has none yet
};

}  // namespace

AssembledPatches assemble_patches(const CadModel& model, std::span<const Foot> feet, std::span<const Vec3> points,
                                  const PatchesOptions& options, const Context& context) {
  AssembledPatches result;
  Assembler(model, feet, points, options, context, result).run();
  return result;
}

}  // namespace tri
