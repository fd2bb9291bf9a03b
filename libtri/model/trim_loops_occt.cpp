#include "libtri/model/trim_loops_occt.hpp"

#include <BRep_Tool.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tri {
namespace {

Vec2 value(const Handle(Geom2d_Curve) & curve, double t) {
  const gp_Pnt2d p = curve->Value(t);
  return {p.X(), p.Y()};
}

bool same_vertex(const WireEdge& a, const WireEdge& b) {
  const TopoDS_Vertex end = TopExp::LastVertex(a.edge, Standard_True),
                      start = TopExp::FirstVertex(b.edge, Standard_True);
  return !end.IsNull() && !start.IsNull() && end.IsSame(start);
}

/// Puts the edges of a wire in running order: the nearest start in (u,v) among those that share the vertex, else among
/// all.
void chain(std::vector<WireEdge>& edges, const Vec2& scale) {
  const auto jump = [&](const WireEdge& a, const WireEdge& b) {
    const Vec2 d = b.start() - a.end();
    return std::hypot(d[0] * scale[0], d[1] * scale[1]);
  };
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    std::size_t best = i + 1;
    double best_cost = std::numeric_limits<double>::infinity();
    for (std::size_t k = i + 1; k < edges.size(); ++k) {
      const double cost = jump(edges[i], edges[k]) + (same_vertex(edges[i], edges[k]) ? 0.0 : 10.0);
      if (cost < best_cost) {
        best_cost = cost;
        best = k;
      }
      if (cost < 1e-9) break;
    }
    std::rotate(edges.begin() + static_cast<std::ptrdiff_t>(i) + 1, edges.begin() + static_cast<std::ptrdiff_t>(best),
                edges.begin() + static_cast<std::ptrdiff_t>(best) + 1);
  }
}

/// Size of the box of some samples of all curves.
Vec2 extent(const std::vector<std::vector<WireEdge>>& loops) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  Vec2 low(inf, inf), high(-inf, -inf);
  for (const auto& loop : loops)
    for (const WireEdge& edge : loop)
      for (int k = 0; k <= 8; ++k) {
        const Vec2 p = value(edge.pcurve, edge.first + (edge.last - edge.first) * k / 8);
        low.minimize(p);
        high.maximize(p);
      }
  return high - low;
}

}  // namespace

Vec2 WireEdge::start() const {
  return value(pcurve, reversed ? last : first);
}
Vec2 WireEdge::end() const {
  return value(pcurve, reversed ? first : last);
}

WireLoops wire_loops(const TopoDS_Face& oriented) {
  WireLoops result;
  const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
  for (TopoDS_Iterator wires(face); wires.More(); wires.Next()) {
    if (wires.Value().ShapeType() != TopAbs_WIRE) continue;
    const TopAbs_Orientation side = wires.Value().Orientation();
    std::vector<WireEdge> loop;
    for (TopoDS_Iterator it(wires.Value()); it.More(); it.Next()) {
      if (it.Value().ShapeType() != TopAbs_EDGE) continue;
      WireEdge use;
      use.edge = TopoDS::Edge(it.Value());
      const TopAbs_Orientation orientation = use.edge.Orientation();
      if ((orientation != TopAbs_FORWARD && orientation != TopAbs_REVERSED) ||
          (side != TopAbs_FORWARD && side != TopAbs_REVERSED)) {
        ++result.internal_edges;
        continue;
      }
      use.reversed = orientation == TopAbs_REVERSED;
      use.pcurve = BRep_Tool::CurveOnSurface(use.edge, face, use.first, use.last);
      if (use.pcurve.IsNull()) {
        result.error = "an edge has no parameter curve and none can be made";
        return result;
      }
      if (!std::isfinite(use.first) || !std::isfinite(use.last) || Precision::IsInfinite(use.first) ||
          Precision::IsInfinite(use.last)) {
        result.error = "an edge is infinite";
        return result;
      }
      loop.push_back(use);
    }
    if (!loop.empty()) result.loops.push_back(std::move(loop));
  }
  if (result.loops.empty()) {
    result.error = "it has no trimming loop";
    return result;
  }
  const Vec2 size = extent(result.loops);
  if (!std::isfinite(size[0]) || !std::isfinite(size[1])) {
    result.error = "a parameter curve is not finite";
    return result;
  }
  const Vec2 scale(size[0] > 0 ? 1 / size[0] : 0, size[1] > 0 ? 1 / size[1] : 0);
  for (auto& loop : result.loops) {
    chain(loop, scale);
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vec2 d = loop[(i + 1) % loop.size()].start() - loop[i].end();
      result.worst_gap = std::max({result.worst_gap, std::abs(d[0] * scale[0]), std::abs(d[1] * scale[1])});
    }
  }
  return result;
}

bool loops_close(const TopoDS_Face& face) {
  try {
    const WireLoops loops = wire_loops(face);
    return loops.error.empty() && loops.worst_gap <= 0.02;
  } catch (const Standard_Failure&) {
    return false;
  }
}

}  // namespace tri
