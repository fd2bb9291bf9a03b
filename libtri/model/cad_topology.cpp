#include "libtri/model/cad_topology.hpp"

#include <set>

#include "meshops/search/disjoint_sets.hpp"

namespace tri {
namespace {

struct EdgeUse {
  std::size_t face;
  int edge;
  bool against;  // seen from outside, the face's boundary runs against the edge
  long partner = -1;
};

std::size_t end_of(std::size_t use, bool edge_end) {
  return 2 * use + (edge_end ? 1 : 0);
}

}  // namespace

CadTopology cad_topology(const CadModel& model) {
  CadTopology result;
  std::vector<EdgeUse> uses;
  std::vector<std::vector<std::size_t>> uses_of_edge(model.edges.size());
  struct Joint {
    std::size_t before, after;
    bool before_reversed, after_reversed;
  };
  std::vector<Joint> joints;
  long point_loops = 0, loop_count = 0;
  for (std::size_t f = 0; f < model.faces.size(); ++f)
    for (const TrimLoop& loop : model.faces[f].loops) {
      ++loop_count;
      const std::size_t begin = uses.size();
      std::vector<bool> reversed;
      for (const Coedge& coedge : loop.coedges) {
        const auto edge = static_cast<std::size_t>(coedge.edge);
        if (model.edges[edge].degenerate) continue;
        uses_of_edge[edge].push_back(uses.size());
        uses.push_back({f, coedge.edge, coedge.reversed != model.faces[f].reversed});
        reversed.push_back(coedge.reversed);
      }
      const std::size_t n = reversed.size();
      if (n == 0) ++point_loops;
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t next = (i + 1) % n;
        joints.push_back({begin + i, begin + next, reversed[i], reversed[next]});
      }
    }

  long edge_count = 0;
  for (std::size_t e = 0; e < model.edges.size(); ++e) {
    const auto& of_edge = uses_of_edge[e];
    if (model.edges[e].degenerate) {
      if (!model.edges[e].faces.empty()) ++result.degenerate_edges;
      continue;
    }
    if (of_edge.empty()) continue;
    edge_count += static_cast<long>(of_edge.size());
    if (of_edge.size() == 1) ++result.free_edges;
    if (of_edge.size() > 2) ++result.nonmanifold_edges;
    if (of_edge.size() != 2) continue;
    if (uses[of_edge[0]].face == uses[of_edge[1]].face) ++result.seam_edges;
    if (uses[of_edge[0]].against == uses[of_edge[1]].against) {
      ++result.incoherent_edges;
      continue;
    }
    uses[of_edge[0]].partner = static_cast<long>(of_edge[1]);
    uses[of_edge[1]].partner = static_cast<long>(of_edge[0]);
    --edge_count;
  }

  // A class of joined ends is one fan of faces around a vertex.
  DisjointSets fans(2 * uses.size());
  for (const Joint& joint : joints)
    fans.join(end_of(joint.before, !joint.before_reversed), end_of(joint.after, joint.after_reversed));
  DisjointSets parts(model.faces.size());
  for (std::size_t u = 0; u < uses.size(); ++u) {
    if (uses[u].partner < 0) continue;
    const auto partner = static_cast<std::size_t>(uses[u].partner);
    for (const bool edge_end : {false, true}) fans.join(end_of(u, edge_end), end_of(partner, edge_end));
    parts.join(uses[u].face, uses[partner].face);
  }

  // Every fan on the boundary has one boundary edge before and one behind it: their chains close.
  DisjointSets chains(fans.size());
  std::set<std::size_t> fan_roots, chain_roots, part_roots;
  for (std::size_t u = 0; u < uses.size(); ++u)
    if (uses[u].partner < 0) chains.join(fans.find(end_of(u, false)), fans.find(end_of(u, true)));
  std::vector<std::set<std::size_t>> fans_of_vertex;
  for (std::size_t u = 0; u < uses.size(); ++u) {
    const CadEdge& edge = model.edges[static_cast<std::size_t>(uses[u].edge)];
    for (const bool edge_end : {false, true}) {
      const std::size_t fan = fans.find(end_of(u, edge_end));
      fan_roots.insert(fan);
      if (uses[u].partner < 0) chain_roots.insert(chains.find(fan));
      const int vertex = edge_end ? edge.end_vertex : edge.start_vertex;
      if (vertex < 0) continue;
      if (fans_of_vertex.size() <= static_cast<std::size_t>(vertex))
        fans_of_vertex.resize(static_cast<std::size_t>(vertex) + 1);
      fans_of_vertex[static_cast<std::size_t>(vertex)].insert(fan);
    }
  }
  for (std::size_t f = 0; f < model.faces.size(); ++f) part_roots.insert(parts.find(f));
  for (const auto& fans_here : fans_of_vertex)
    if (fans_here.size() > 1) ++result.nonmanifold_vertices;

  result.components = static_cast<long>(part_roots.size());
  result.loops = static_cast<long>(chain_roots.size());
  result.euler = static_cast<long>(fan_roots.size()) + point_loops - edge_count +
                 2 * static_cast<long>(model.faces.size()) - loop_count;
  return result;
}

}  // namespace tri
