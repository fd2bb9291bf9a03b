#include "libtri/sampling/sampling_model.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBuilderAPI_Copy.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "libtri/model/shape_occt.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr double relative_deflection = 1e-3;  // of the diagonal
constexpr double angular_deflection = 0.3;    // rad
constexpr int chord_parts = 8;                // a trimming curve between two nodes; reduces its sagitta by the square

Vec3 to_vec3(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}
Vec3 to_vec3(const gp_Vec& v) {
  return {v.X(), v.Y(), v.Z()};
}

struct FaceTools {
  explicit FaceTools(const TopoDS_Face& face) : surface(face), trim(face, 1e-9) {}
  BRepAdaptor_Surface surface;
  BRepTopAdaptor_FClass2d trim;
};

}  // namespace

struct SamplingModel::Impl {
  std::vector<TopoDS_Face> faces;
  // An adaptor caches the span it was last in, so no two threads may share one.
  mutable tbb::enumerable_thread_specific<std::vector<std::unique_ptr<FaceTools>>> tools;

  FaceTools& local(std::int32_t face) const {
    auto& own = tools.local();
    own.resize(faces.size());
    if (!own[face]) own[face] = std::make_unique<FaceTools>(faces[face]);
    return *own[face];
  }
};

namespace {

// Of the surfaces within the parameter boxes of the faces: a little too long where a face fills its box badly. (The
// exact boxes of OpenCASCADE take longer than all the tessellation.)
double rough_diagonal(const TopTools_IndexedMapOfShape& faces) {
  constexpr int steps = 8;
  Vec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (int i = 1; i <= faces.Extent(); ++i) {
    const TopoDS_Face& face = TopoDS::Face(faces(i));
    double u0, u1, v0, v1;
    BRepTools::UVBounds(face, u0, u1, v0, v1);
    if (Precision::IsInfinite(u0) || Precision::IsInfinite(u1) || Precision::IsInfinite(v0) ||
        Precision::IsInfinite(v1))
      continue;
    const BRepAdaptor_Surface surface(face, false);
    for (int j = 0; j <= steps; ++j) {
      for (int k = 0; k <= steps; ++k) {
        const Vec3 p = to_vec3(surface.Value(u0 + (u1 - u0) * j / steps, v0 + (v1 - v0) * k / steps));
        low.minimize(p);
        high.maximize(p);
      }
    }
  }
  const double diagonal = (high - low).norm();
  if (!(diagonal > 0) || !std::isfinite(diagonal)) throw CadError("virtual measurement: the model has no extent");
  return diagonal;
}

// Adds one face's triangles to the lists, and refines them along the trimming curves.
class FaceMesher {
 public:
  FaceMesher(std::vector<SamplingModel::Node>& nodes, std::vector<SamplingModel::Facet>& facets)
      : nodes_(nodes), facets_(facets) {}

  // False if the face has no usable triangle.
  bool add(const TopoDS_Face& face, std::int32_t position, SamplingModel::Face& info) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    if (mesh.IsNull() || mesh->NbTriangles() == 0 || !mesh->HasUVNodes()) return false;
    first_node_ = static_cast<std::uint32_t>(nodes_.size());
    const auto first_facet = static_cast<std::uint32_t>(facets_.size());
    const BRepAdaptor_Surface surface(face);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    info.uv_min = Vec2(infinity);
    info.uv_max = Vec2(-infinity);
    for (int i = 1; i <= mesh->NbNodes(); ++i) {
      const gp_Pnt2d uv = mesh->UVNode(i);
      add_node(surface, {uv.X(), uv.Y()}, info);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::uint32_t, int>> edges;  // to facet and opposite
                                                                                             // corner
    for (int i = 1; i <= mesh->NbTriangles(); ++i) {
      int a, b, c;
      mesh->Triangle(i).Get(a, b, c);
      const auto node = [&](int k) { return first_node_ + static_cast<std::uint32_t>(k - 1); };
      const SamplingModel::Facet facet{position, {node(a), node(b), node(c)}, {}};
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t p = facet.nodes[(k + 1) % 3], q = facet.nodes[(k + 2) % 3];
        edges[std::minmax(p, q)] = {static_cast<std::uint32_t>(facets_.size()), k};
      }
      facets_.push_back(facet);
    }
    info.scale = mean_scale(surface, first_facet);
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      if (BRep_Tool::Degenerated(edge)) continue;
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
      double first, last;
      const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
      if (polygon.IsNull() || curve.IsNull() || !polygon->HasParameters()) continue;
      for (int k = 1; k < polygon->NbNodes(); ++k) {
        const std::uint32_t a = first_node_ + polygon->Node(k) - 1, b = first_node_ + polygon->Node(k + 1) - 1;
        const auto owner = edges.find(std::minmax(a, b));
        if (owner == edges.end()) continue;
        follow(surface, curve, polygon->Parameter(k), polygon->Parameter(k + 1), a, b, owner->second, info);
      }
    }
    info.first_facet = first_facet;
    info.facet_count = static_cast<std::uint32_t>(facets_.size()) - first_facet;
    return true;
  }

 private:
  void add_node(const BRepAdaptor_Surface& surface, const Vec2& uv, SamplingModel::Face& info) {
    nodes_.push_back({uv, to_vec3(surface.Value(uv[0], uv[1]))});
    info.uv_min.minimize(uv);
    info.uv_max.maximize(uv);
  }

  Vec2 mean_scale(const BRepAdaptor_Surface& surface, std::uint32_t first_facet) const {
    Vec2 sum(0, 0);
    double weights = 0;
    for (std::size_t f = first_facet; f < facets_.size(); ++f) {
      const auto& n = facets_[f].nodes;
      const Vec2 a = nodes_[n[0]].uv, b = nodes_[n[1]].uv, c = nodes_[n[2]].uv, middle = (a + b + c) / 3.0;
      gp_Pnt p;
      gp_Vec du, dv;
      surface.D1(middle[0], middle[1], p, du, dv);
      const double weight = std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
      sum += Vec2(du.Magnitude(), dv.Magnitude()) * weight;
      weights += weight;
    }
    if (weights > 0) sum /= weights;
    return {sum[0] > 0 ? sum[0] : 1, sum[1] > 0 ? sum[1] : 1};
  }

  // Between nodes a and b the trimming curve leaves the chord: outward it adds a fan of facets, inward it leaves a
  // band.
  void follow(const BRepAdaptor_Surface& surface, const Handle(Geom2d_Curve) & curve, double from, double to,
              std::uint32_t a, std::uint32_t b, std::pair<std::uint32_t, int> owner, SamplingModel::Face& info) {
    const Vec2 scale = info.scale;
    const auto scaled = [&](const Vec2& uv) { return Vec2(uv[0] * scale[0], uv[1] * scale[1]); };
    const Vec2 start = scaled(nodes_[a].uv), chord = scaled(nodes_[b].uv) - start;
    const double length = chord.norm();
    if (length == 0) return;
    const auto side = [&](const Vec2& uv) {
      const Vec2 d = scaled(uv) - start;
      return (chord[0] * d[1] - chord[1] * d[0]) / length;
    };
    const double inner = side(nodes_[facets_[owner.first].nodes[owner.second]].uv) < 0 ? -1 : 1;
    std::array<Vec2, chord_parts - 1> between;
    double inward = 0, outward = 0;
    for (int j = 1; j < chord_parts; ++j) {
      const gp_Pnt2d p = curve->Value(from + (to - from) * j / chord_parts);
      between[j - 1] = {p.X(), p.Y()};
      const double distance = inner * side(between[j - 1]);
      inward = std::max(inward, distance);
      outward = std::max(outward, -distance);
    }
    const double negligible = 1e-9 * length;
    if (inward > negligible) {
      float& band = facets_[owner.first].band[owner.second];
      band = std::max(band, static_cast<float>(1.1 * inward));
    } else if (outward > negligible) {
      const std::int32_t position = facets_[owner.first].face;
      std::uint32_t previous = static_cast<std::uint32_t>(nodes_.size());
      for (const Vec2& uv : between) add_node(surface, uv, info);
      for (int j = 0; j + 1 < chord_parts - 1; ++j, ++previous)
        facets_.push_back({position, {a, previous, previous + 1}, {}});
      facets_.push_back({position, {a, previous, b}, {}});
    }
  }

  std::vector<SamplingModel::Node>& nodes_;
  std::vector<SamplingModel::Facet>& facets_;
  std::uint32_t first_node_ = 0;
};

}  // namespace

SamplingModel::SamplingModel(const Shape& shape, Context& context) : impl_(std::make_unique<Impl>()) {
  if (shape.empty()) throw CadError("virtual measurement: the model is empty");
  try {
    TopTools_IndexedMapOfShape map;
    TopExp::MapShapes(occt(shape), TopAbs_FACE, map);
    deflection_ = relative_deflection * rough_diagonal(map);
    FaceMesher mesher(nodes_, facets_);
    for (int i = 1; i <= map.Extent(); ++i) {
      context.checkpoint();
      context.progress("tessellate", double(i - 1) / map.Extent());
      // Its own copy: a tessellation is stored in the face, and the caller's shape may be in use elsewhere.
      const TopoDS_Face face = TopoDS::Face(BRepBuilderAPI_Copy(map(i), true, false).Shape());
      BRepMesh_IncrementalMesh(face, deflection_, false, angular_deflection);
      Face info;
      info.index = i;
      if (mesher.add(face, static_cast<std::int32_t>(faces_.size()), info)) {
        faces_.push_back(info);
        impl_->faces.push_back(face);
      } else {
        unusable_faces_.push_back(i);
      }
    }
  } catch (const Standard_Failure& failure) {
    throw CadError(fmt::format("virtual measurement: {}", failure.GetMessageString()));
  }
  if (faces_.empty()) throw CadError("virtual measurement: no face of the model can be sampled");
  Vec3 low = nodes_[0].point, high = low;
  for (const Node& node : nodes_) {
    low.minimize(node.point);
    high.maximize(node.point);
  }
  diagonal_ = (high - low).norm();
}

SamplingModel::~SamplingModel() = default;

SamplingModel::Sample SamplingModel::sample(std::int32_t face, const Vec2& uv) const {
  gp_Pnt p;
  gp_Vec du, dv;
  impl_->local(face).surface.D1(uv[0], uv[1], p, du, dv);
  Sample result{to_vec3(p), to_vec3(du) % to_vec3(dv), 0};
  result.stretch = result.normal.norm();
  if (result.stretch > 0)
    result.normal /= impl_->faces[face].Orientation() == TopAbs_REVERSED ? -result.stretch : result.stretch;
  return result;
}

bool SamplingModel::inside(const Facet& facet, const Vec2& uv) const {
  const Vec2 scale = faces_[facet.face].scale;
  const auto scaled = [&](const Vec2& x) { return Vec2(x[0] * scale[0], x[1] * scale[1]); };
  const Vec2 point = scaled(uv);
  for (int k = 0; k < 3; ++k) {
    if (facet.band[k] <= 0) continue;
    const Vec2 a = scaled(nodes_[facet.nodes[(k + 1) % 3]].uv), chord = scaled(nodes_[facet.nodes[(k + 2) % 3]].uv) - a;
    const Vec2 d = point - a;
    if (std::abs(chord[0] * d[1] - chord[1] * d[0]) >= facet.band[k] * chord.norm()) continue;
    const TopAbs_State state = impl_->local(facet.face).trim.Perform(gp_Pnt2d(uv[0], uv[1]), false);
    return state == TopAbs_IN || state == TopAbs_ON;
  }
  return true;
}

}  // namespace tri
