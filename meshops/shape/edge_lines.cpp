#include "meshops/shape/edge_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "meshops/editing/attribute_seams.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/search/disjoint_sets.hpp"

namespace tri {

EdgeLines::EdgeLines(MeshView view, const FeatureRules& rules, const Context& context) {
  const OpenMesh::TriConnectivity& mesh = view.mesh;
  const Features features = find_features(view, rules, context);
  const std::vector<std::uint8_t> seams = attribute_seams(view);
  context.checkpoint();
  const auto on_line = [&](EdgeHandle e) {
    return features.is_feature(e) || (!seams.empty() && seams[static_cast<std::size_t>(e.idx())]);
  };
  Pace pace(context);
  lines_.assign(mesh.n_edges(), none);
  kinds_.assign(mesh.n_vertices(), Kind::fixed);
  DisjointSets sets(mesh.n_edges());
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    pace();
    const VertexHandle v(static_cast<int>(i));
    const HalfedgeHandle first = mesh.halfedge_handle(v);
    if (mesh.status(v).deleted() || !first.is_valid() || !std::isfinite(view.point(v).sqrnorm())) continue;
    HalfedgeHandle arms[2];
    int count = 0;
    HalfedgeHandle h = first;
    do {
      if (on_line(mesh.edge_handle(h))) {
        if (count < 2) arms[count] = h;
        ++count;
      }
      h = mesh.opposite_halfedge_handle(mesh.prev_halfedge_handle(h));
    } while (h != first);
    if (!view.may_remove(v)) continue;
    if (count == 0) kinds_[i] = Kind::free;
    if (count != 2) continue;
    const Vec3 in = view.point(v) - view.point(mesh.to_vertex_handle(arms[0]));
    const Vec3 out = view.point(mesh.to_vertex_handle(arms[1])) - view.point(v);
    if (std::atan2((in % out).norm(), in | out) > rules.corner_angle) continue;
    kinds_[i] = Kind::along;
    sets.join(static_cast<std::size_t>(mesh.edge_handle(arms[0]).idx()),
              static_cast<std::size_t>(mesh.edge_handle(arms[1]).idx()));
  }
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < mesh.n_edges(); ++i) {
    pace();
    const EdgeHandle e(static_cast<int>(i));
    if (mesh.status(e).deleted() || !on_line(e)) continue;
    const HalfedgeHandle h = mesh.halfedge_handle(e, 0);
    const Segment s{view.point(mesh.from_vertex_handle(h)), view.point(mesh.to_vertex_handle(h)),
                    static_cast<std::int32_t>(sets.find(i))};
    lines_[i] = s.line;
    if (!std::isfinite(s.a.sqrnorm()) || !std::isfinite(s.b.sqrnorm())) continue;
    Box box{s.a, s.a};
    box.low.minimize(s.b);
    box.high.maximize(s.b);
    segments_.push_back(s);
    boxes.push_back(box);
  }
  tree_ = BoxTree(boxes, &context);
}

Vec3 EdgeLines::closest(const Vec3& p, std::int32_t line) const {
  Vec3 best = p;
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t at = std::numeric_limits<std::uint32_t>::max();
  tree_.search(
      p, [&] { return distance; },
      [&](std::uint32_t i) {
        const Segment& s = segments_[i];
        if (s.line != line) return;
        const Vec3 q = closest_on_segment(s.a, s.b, p);
        const double d = (q - p).norm();
        if (d < distance || (d == distance && i < at)) best = q, distance = d, at = i;
      });
  return best;
}

double EdgeLines::chord_error(const Vec3& from, const Vec3& to, std::int32_t line) const {
  double most = 0;
  for (const double share : {0.25, 0.5, 0.75}) {
    const Vec3 p = from + share * (to - from);
    most = std::max(most, (closest(p, line) - p).norm());
  }
  return most;
}

}  // namespace tri
