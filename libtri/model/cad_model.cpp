#include "libtri/model/cad_model.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <BRep_Tool.hxx>
#include <Geom2dAdaptor_Curve.hxx>
#include <GeomAdaptor_Curve.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libtri/model/cad_polylines.hpp"
#include "libtri/model/face_measure.hpp"
#include "libtri/model/shape_occt.hpp"
#include "libtri/model/shape_preparation_occt.hpp"
#include "libtri/model/trim_loops_occt.hpp"
#include "libtri/surfaces/adaptive_polyline.hpp"
#include "libtri/surfaces/geometry_occt.hpp"
#include "meshops/error.hpp"
#include "meshops/search/disjoint_sets.hpp"

namespace tri {
namespace {

constexpr double chord_share = 1e-5;  // of the diagonal

Vec3 to_vec(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}

double chord_distance(const Vec3& a, const Vec3& p, const Vec3& b) {
  const Vec3 chord = b - a, d = p - a;
  const double cc = chord | chord;
  const double share = cc > 0 ? std::clamp((d | chord) / cc, 0.0, 1.0) : 0.0;
  return (d - share * chord).norm();
}

std::string describe(const Standard_Failure& failure) {
  const char* text = failure.GetMessageString();
  return fmt::format("OpenCASCADE: {} {}", failure.DynamicType()->Name(), text ? text : "");
}

const char* type_name(GeomAbs_SurfaceType type) {
  switch (type) {
    case GeomAbs_Plane:
      return "plane";
    case GeomAbs_Cylinder:
      return "cylinder";
    case GeomAbs_Cone:
      return "cone";
    case GeomAbs_Sphere:
      return "sphere";
    case GeomAbs_Torus:
      return "torus";
    case GeomAbs_BezierSurface:
      return "bezier";
    case GeomAbs_BSplineSurface:
      return "b-spline";
    case GeomAbs_SurfaceOfRevolution:
      return "revolution";
    case GeomAbs_SurfaceOfExtrusion:
      return "extrusion";
    case GeomAbs_OffsetSurface:
      return "offset";
    default:
      return "other";
  }
}

/// Breaks of one direction of a surface within [low, high], periods included, and at least eight pieces.
std::vector<double> breaks_within(const std::vector<ParameterBreak>& breaks, double period, double low, double high) {
  std::vector<double> result;
  for (const ParameterBreak& at : breaks) {
    if (period <= 0) {
      result.push_back(at.at);
      continue;
    }
    for (double t = at.at - std::floor((at.at - low) / period) * period; t < high; t += period) result.push_back(t);
  }
  return breaks_between(low, high, std::move(result), 8);
}

/// Where the pieces of a curve meet; a straight line has none and needs few pieces.
template <class Adaptor>
std::vector<double> inner_breaks(const Adaptor& adaptor) {
  const int n = adaptor.NbIntervals(GeomAbs_C2);
  TColStd_Array1OfReal intervals(1, n + 1);
  adaptor.Intervals(intervals, GeomAbs_C2);
  std::vector<double> result;
  for (int i = 2; i <= n; ++i) result.push_back(intervals(i));
  return result;
}

/// Reads the faces of a prepared shape one by one.
class Reader {
 public:
  Reader(const Shape& source, PreparedShape prepared, Context& context)
      : source_(source), prepared_(std::move(prepared)), context_(context) {
    TopExp::MapShapes(prepared_.shape, TopAbs_FACE, faces_);
    TopExp::MapShapes(prepared_.shape, TopAbs_EDGE, edges_);
    TopExp::MapShapes(prepared_.shape, TopAbs_VERTEX, vertices_);
  }

  CadModel read() {
    model_.shape = make_shape(prepared_.shape);
    model_.warnings = prepared_.warnings;
    read_scale();
    for (int i = 1; i <= vertices_.Extent(); ++i)
      model_.vertices.push_back(to_vec(BRep_Tool::Pnt(TopoDS::Vertex(vertices_(i)))));
    const std::size_t all = static_cast<std::size_t>(edges_.Extent()) + prepared_.faces.size();
    std::size_t done = 0;
    const auto step = [&] {
      context_.checkpoint();
      context_.progress("read faces", static_cast<double>(done++) / static_cast<double>(all));
    };
    for (int i = 1; i <= edges_.Extent(); ++i) {
      step();
      model_.edges.push_back(read_edge(TopoDS::Edge(edges_(i))));
    }
    for (std::size_t i = 0; i < prepared_.faces.size(); ++i) {
      step();
      read_face(i);
    }
    context_.progress("read faces", 1);
    if (model_.faces.empty()) throw CadError(no_face_message());
    read_box();
    number_shells();
    return std::move(model_);
  }

 private:
  std::string name_of(std::size_t i) const {
    const auto& names = source_.impl().face_names;
    return i < names.size() ? names[i] : std::string();
  }

  /// The size of the model, good enough to measure tolerances against: from vertices and points on edges.
  void read_scale() {
    clear_box();
    TopTools_IndexedMapOfShape used;  // a file may hold curves beside its faces
    for (int i = 1; i <= faces_.Extent(); ++i) TopExp::MapShapes(faces_(i), TopAbs_EDGE, used);
    for (int i = 1; i <= used.Extent(); ++i) {
      double first, last;
      const Handle(Geom_Curve) curve = BRep_Tool::Curve(TopoDS::Edge(used(i)), first, last);
      if (curve.IsNull() || Precision::IsInfinite(first) || Precision::IsInfinite(last)) continue;
      for (int k = 0; k <= 8; ++k) add_to_box(to_vec(curve->Value(first + (last - first) * k / 8)));
    }
    const double diagonal = (model_.box_max - model_.box_min).norm();
    model_.diagonal = std::isfinite(diagonal) ? diagonal : 0;
  }

  /// The tight box: edges, and the inside of faces where they bulge out.
  void read_box() {
    clear_box();
    for (const CadEdge& edge : model_.edges)
      if (!edge.faces.empty())
        for (const Vec3& p : edge.polyline) add_to_box(p);
    const double slack = 2 * tolerance();
    for (std::size_t e = 0; e < model_.edges.size(); ++e)
      if (!model_.edges[e].faces.empty() && !model_.edges[e].degenerate) add_extremes(static_cast<int>(e) + 1, slack);
    for (std::size_t f = 0; f < model_.faces.size(); ++f)
      extend_box(model_.faces[f], breaks_[f], model_.box_min, model_.box_max);
    model_.diagonal = (model_.box_max - model_.box_min).norm();
  }

  void clear_box() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    model_.box_min = Vec3(inf, inf, inf);
    model_.box_max = -model_.box_min;
  }
  void add_to_box(const Vec3& p) {
    model_.box_min.minimize(p);
    model_.box_max.maximize(p);
  }

  /// Where the polyline of an edge comes within `slack` of the box, its curve may reach beyond.
  void add_extremes(int edge_index, double slack) {
    const std::vector<Vec3>& line = model_.edges[static_cast<std::size_t>(edge_index) - 1].polyline;
    double first, last;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(TopoDS::Edge(edges_(edge_index)), first, last);
    if (curve.IsNull() || line.size() < 3) return;
    for (int axis = 0; axis < 3; ++axis) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Vec3& p : line) low = std::min(low, p[axis]), high = std::max(high, p[axis]);
      if (low > model_.box_min[axis] + slack && high < model_.box_max[axis] - slack) continue;
      constexpr int samples = 256;
      for (const double sign : {-1.0, 1.0}) {
        const auto value = [&](double t) { return sign * to_vec(curve->Value(t))[axis]; };
        int best = 0;
        for (int k = 1; k <= samples; ++k)
          if (value(first + (last - first) * k / samples) > value(first + (last - first) * best / samples)) best = k;
        const double t0 = first + (last - first) * std::max(best - 1, 0) / samples;
        const double t1 = first + (last - first) * std::min(best + 1, samples) / samples;
        const double extreme = sign * golden_maximum(t0, t1, value);
        model_.box_min[axis] = std::min(model_.box_min[axis], extreme);
        model_.box_max[axis] = std::max(model_.box_max[axis], extreme);
      }
    }
  }

  double tolerance() const { return chord_share * model_.diagonal; }

  CadEdge read_edge(const TopoDS_Edge& oriented) const {
    const TopoDS_Edge edge = TopoDS::Edge(oriented.Oriented(TopAbs_FORWARD));
    CadEdge result;
    result.tolerance = BRep_Tool::Tolerance(edge);
    result.degenerate = BRep_Tool::Degenerated(edge);
    const TopoDS_Vertex start = TopExp::FirstVertex(edge), end = TopExp::LastVertex(edge);
    if (!start.IsNull()) result.start_vertex = vertices_.FindIndex(start) - 1;
    if (!end.IsNull()) result.end_vertex = vertices_.FindIndex(end) - 1;
    double first, last;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, first, last);
    if (result.degenerate) {
      if (result.start_vertex >= 0) result.polyline = {model_.vertices[static_cast<std::size_t>(result.start_vertex)]};
    } else if (!curve.IsNull() && !Precision::IsInfinite(first) && !Precision::IsInfinite(last)) {
      const GeomAdaptor_Curve adaptor(curve, first, last);
      result.polyline = space_polyline([&](double t) { return to_vec(adaptor.Value(t)); }, first, last,
                                       inner_breaks(adaptor), adaptor.GetType() == GeomAbs_Line ? 1 : 12);
    }
    return result;
  }

  template <class Point>
  std::vector<Vec3> space_polyline(Point point, double first, double last, std::vector<double> inner,
                                   int pieces) const {
    const auto deviation = [&](double t0, double t, double t1) {
      return chord_distance(point(t0), point(t), point(t1));
    };
    std::vector<Vec3> result;
    for (const double t :
         adaptive_parameters(breaks_between(first, last, std::move(inner), pieces), deviation, tolerance()))
      result.push_back(point(t));
    return result;
  }

  void read_face(std::size_t i) {
    const int index = static_cast<int>(i) + 1;
    std::string reason = prepared_.lost[i];
    CadFace face;
    face.index = index;
    face.name = name_of(i);
    if (reason.empty()) {
      try {
        reason = fill_face(TopoDS::Face(prepared_.faces[i]), face);
      } catch (const Standard_Failure& failure) {
        reason = describe(failure);
      } catch (const Error& failure) {
        reason = failure.what();
      }
    }
    if (!reason.empty()) {
      model_.unusable_faces.push_back({index, face.name, reason});
      return;
    }
    const int position = static_cast<int>(model_.faces.size());
    for (const TrimLoop& loop : face.loops)
      for (const Coedge& coedge : loop.coedges)
        model_.edges[static_cast<std::size_t>(coedge.edge)].faces.push_back(position);
    model_.faces.push_back(std::move(face));
  }

  /// Returns why the face cannot be used, or "".
  std::string fill_face(const TopoDS_Face& shape, CadFace& face) {
    face.shape_face = faces_.FindIndex(shape);
    face.reversed = faces_(face.shape_face).Orientation() == TopAbs_REVERSED;
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(shape);
    if (surface.IsNull()) return "it has no surface";
    face.surface_type = type_name(GeomAdaptor_Surface(surface).GetType());
    const WireLoops wires = wire_loops(shape);
    if (!wires.error.empty()) return wires.error;
    if (wires.worst_gap > 0.25)
      return fmt::format("a trimming loop does not close: it jumps over {:.0f}% of the parameter box",
                         100 * wires.worst_gap);
    if (wires.worst_gap > 0.02)
      warn(face, fmt::format("a trimming loop jumps over {:.1f}% of the parameter box", 100 * wires.worst_gap));
    if (wires.internal_edges > 0)
      warn(face, fmt::format("{} edges inside its material are left out", wires.internal_edges));
    face.surface = make_surface(surface);
    face.u_min = face.v_min = std::numeric_limits<double>::infinity();
    face.u_max = face.v_max = -std::numeric_limits<double>::infinity();
    std::vector<std::vector<ParameterPolyline>> lines;
    for (const auto& wire : wires.loops) {
      TrimLoop loop;
      lines.emplace_back();
      for (const WireEdge& use : wire) {
        lines.back().emplace_back();
        loop.coedges.push_back(read_coedge(use, face, lines.back().back()));
      }
      face.loops.push_back(std::move(loop));
    }
    for (const double bound : {face.u_min, face.u_max, face.v_min, face.v_max})
      if (!std::isfinite(bound)) return "its parameter box is not finite";
    double worst_departure = 0;
    for (const TrimLoop& loop : face.loops)
      for (const Coedge& coedge : loop.coedges) worst_departure = std::max(worst_departure, departure(coedge, face));
    if (worst_departure > 0)
      warn(face, fmt::format("a trimming curve in (u,v) leaves its edge in space by {:.3g} mm", worst_departure));
    const SurfaceBreaks breaks{
        breaks_within(face.surface->u_breaks(), face.surface->u_period(), face.u_min, face.u_max),
        breaks_within(face.surface->v_breaks(), face.surface->v_period(), face.v_min, face.v_max)};
    std::vector<double> areas;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      std::vector<double> shares(lines[k].size());
      tbb::parallel_for(std::size_t{0}, shares.size(), [&](std::size_t i) {
        const Coedge& coedge = face.loops[k].coedges[i];
        shares[i] = area_share(*face.surface, breaks, *coedge.pcurve, lines[k][i], face.u_min);
        if (coedge.reversed) shares[i] = -shares[i];
      });
      areas.push_back(std::accumulate(shares.begin(), shares.end(), 0.0));
      if (!std::isfinite(areas[k])) return "its area is not finite";
    }
    orient_loops(face, areas);
    for (const double area : areas) face.area += area;
    const double smallest = std::pow(1e-9 * model_.diagonal, 2);
    if (face.area <= smallest) return fmt::format("its area is zero ({:.3g} mm^2)", face.area);
    breaks_.push_back(breaks);
    return {};
  }

  Coedge read_coedge(const WireEdge& use, CadFace& face, ParameterPolyline& line) const {
    Coedge coedge;
    coedge.edge = edges_.FindIndex(use.edge) - 1;
    coedge.reversed = use.reversed;
    coedge.first = use.first;
    coedge.last = use.last;
    coedge.pcurve = make_curve2(use.pcurve, use.first, use.last);
    const Geom2dAdaptor_Curve adaptor(use.pcurve, use.first, use.last);
    line = parameter_polyline(*coedge.pcurve, use.first, use.last, *face.surface, inner_breaks(adaptor),
                              adaptor.GetType() == GeomAbs_Line ? 4 : 12, tolerance());
    extend_range(*coedge.pcurve, line, 0, face.u_min, face.u_max);
    extend_range(*coedge.pcurve, line, 1, face.v_min, face.v_max);
    coedge.polyline = line.points;
    if (use.reversed) std::reverse(coedge.polyline.begin(), coedge.polyline.end());
    return coedge;
  }

  /// How far the parameter curve leaves the edge in space, in mm, at a few places; 0 if within the edge's tolerance.
  double departure(const Coedge& coedge, const CadFace& face) const {
    const CadEdge& edge = model_.edges[static_cast<std::size_t>(coedge.edge)];
    if (edge.polyline.size() < 2) return 0;
    double worst = 0;
    for (int k = 0; k <= 4; ++k) {
      const Vec2 uv = coedge.pcurve->point(coedge.first + (coedge.last - coedge.first) * k / 4);
      const Vec3 p = face.surface->point(uv[0], uv[1]);
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i + 1 < edge.polyline.size(); ++i)
        nearest = std::min(nearest, chord_distance(edge.polyline[i], p, edge.polyline[i + 1]));
      worst = std::max(worst, nearest);
    }
    return worst > 2 * edge.tolerance + 10 * tolerance() ? worst : 0;
  }

  /// Material to the left of every loop: outer loops run counter-clockwise, holes clockwise.
  /// @param areas  signed area of each loop on the surface; negated where a loop is turned round
  void orient_loops(CadFace& face, std::vector<double>& areas) {
    const std::size_t n = face.loops.size();
    std::vector<std::vector<Vec2>> polygons(n);
    for (std::size_t k = 0; k < n; ++k)
      for (const Coedge& coedge : face.loops[k].coedges)
        polygons[k].insert(polygons[k].end(), coedge.polyline.begin(), coedge.polyline.end());
    for (std::size_t k = 0; k < n; ++k) {
      int depth = 0;
      for (std::size_t m = 0; m < n; ++m)
        if (m != k && std::abs(areas[m]) > std::abs(areas[k]) && mostly_inside(polygons[k], polygons[m])) ++depth;
      TrimLoop& loop = face.loops[k];
      loop.outer = depth % 2 == 0;
      if (areas[k] == 0 || loop.outer == (areas[k] > 0)) continue;
      reverse(loop);
      areas[k] = -areas[k];
      warn(face, loop.outer ? "its outer loop ran backwards" : "the loop of a hole ran backwards");
    }
  }

  static bool mostly_inside(const std::vector<Vec2>& inner, const std::vector<Vec2>& outer) {
    int votes = 0;
    for (std::size_t s = 0; s < 5; ++s) votes += inside_polygon(outer, inner[s * inner.size() / 5]) ? 1 : -1;
    return votes > 0;
  }

  static void reverse(TrimLoop& loop) {
    std::reverse(loop.coedges.begin(), loop.coedges.end());
    for (Coedge& coedge : loop.coedges) {
      coedge.reversed = !coedge.reversed;
      std::reverse(coedge.polyline.begin(), coedge.polyline.end());
    }
  }

  void number_shells() {
    DisjointSets sets(model_.faces.size());
    for (const CadEdge& edge : model_.edges)
      for (const int f : edge.faces)
        sets.join(static_cast<std::size_t>(f), static_cast<std::size_t>(edge.faces.front()));
    std::vector<int> number(model_.faces.size(), -1);
    int count = 0;
    for (std::size_t f = 0; f < model_.faces.size(); ++f) {
      int& shell = number[sets.find(f)];
      if (shell < 0) shell = count++;
      model_.faces[f].shell = shell;
    }
  }

  void warn(const CadFace& face, const std::string& text) {
    model_.warnings.push_back(
        fmt::format("face {}{}: {}", face.index, face.name.empty() ? "" : " (" + face.name + ")", text));
  }

  std::string no_face_message() const {
    if (model_.unusable_faces.empty()) return "the model holds no face";
    const UnusableFace& first = model_.unusable_faces.front();
    return fmt::format("none of the model's {} faces can be used; face {}: {}", model_.unusable_faces.size(),
                       first.index, first.reason);
  }

  const Shape& source_;
  PreparedShape prepared_;
  Context& context_;
  TopTools_IndexedMapOfShape faces_, edges_, vertices_;
  std::vector<SurfaceBreaks> breaks_;  // beside model_.faces
  CadModel model_;
};

}  // namespace

CadModel make_cad_model(const Shape& shape, double sew_tolerance) {
  Context context;
  return make_cad_model(shape, sew_tolerance, context);
}

CadModel make_cad_model(const Shape& shape, double sew_tolerance, Context& context) {
  if (shape.empty() || occt(shape).IsNull()) throw InvalidInput("make_cad_model: the shape is empty");
  if (!(sew_tolerance > 0) || !std::isfinite(sew_tolerance))
    throw InvalidInput(fmt::format("make_cad_model: the sewing tolerance is {}, must be above 0", sew_tolerance));
  try {
    return Reader(shape, prepare_shape(occt(shape), sew_tolerance, context), context).read();
  } catch (const Standard_Failure& failure) {
    throw CadError("the model cannot be prepared: " + describe(failure));
  }
}

}  // namespace tri
