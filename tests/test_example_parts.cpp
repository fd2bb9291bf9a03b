#include <doctest/doctest.h>

#include <BRepAdaptor_Curve2d.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <tuple>

#include "io/cad/cad_file.hpp"
#include "libtri/example_parts.hpp"
#include "libtri/model/shape_occt.hpp"
#include "meshops/error.hpp"
#include "meshops/vec.hpp"

using namespace tri;

namespace {

struct PartTopology {
  int components = 0, loops = 0, euler = 0;
  bool manifold = true;
};

struct UnionFind {
  std::vector<int> parent;
  int find(int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  }
  void join(int i, int j) { parent[find(i)] = find(j); }
};

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum type) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, type, map);
  return map.Extent();
}

// The topology of OpenCASCADE's own tessellation: the nodes of neighbouring faces are the same where they lie on the
// same edge, whatever their coordinates.
PartTopology part_topology(const TopoDS_Shape& shape, double deflection) {
  BRepMesh_IncrementalMesh(shape, deflection, false, 0.4);
  TopTools_IndexedMapOfShape faces, edges;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  UnionFind nodes;
  std::vector<std::array<int, 3>> triangles;
  std::map<std::pair<int, int>, int> on_edge;  // (edge, position along it) -> node
  for (int f = 1; f <= faces.Extent(); ++f) {
    const TopoDS_Face& face = TopoDS::Face(faces(f));
    TopLoc_Location location;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, location);
    REQUIRE(!mesh.IsNull());
    const int first = int(nodes.parent.size());
    nodes.parent.resize(first + mesh->NbNodes());
    std::iota(nodes.parent.begin() + first, nodes.parent.end(), first);
    for (int t = 1; t <= mesh->NbTriangles(); ++t) {
      int a, b, c;
      mesh->Triangle(t).Get(a, b, c);
      if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
      triangles.push_back({first + a - 1, first + b - 1, first + c - 1});
    }
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
      const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, mesh, location);
      REQUIRE(!polygon.IsNull());
      const int id = edges.Add(edge.Oriented(TopAbs_FORWARD));
      for (int k = 1; k <= polygon->NbNodes(); ++k) {
        const int node = first + polygon->Node(k) - 1;
        const int position = BRep_Tool::Degenerated(edge) ? 1 : k;
        const auto [place, fresh] = on_edge.try_emplace({id, position}, node);
        if (!fresh) nodes.join(node, place->second);
      }
      // End nodes are those of the vertices, which may join edges of different faces.
      int ends[2] = {first + polygon->Node(1) - 1, first + polygon->Node(polygon->NbNodes()) - 1};
      const TopoDS_Vertex vertices[2] = {TopExp::FirstVertex(edge), TopExp::LastVertex(edge)};
      for (int k = 0; k < 2; ++k) {
        const int vertex = edges.Add(vertices[k].Oriented(TopAbs_FORWARD));
        const auto [place, fresh] = on_edge.try_emplace({vertex, 0}, ends[k]);
        if (!fresh) nodes.join(ends[k], place->second);
      }
    }
  }
  std::map<std::pair<int, int>, int> directed;
  std::set<int> used;
  int faces_left = 0;
  UnionFind parts{std::vector<int>(nodes.parent.size())};
  std::iota(parts.parent.begin(), parts.parent.end(), 0);
  for (std::array<int, 3> t : triangles) {
    for (int& node : t) node = nodes.find(node);
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;  // at a pole
    ++faces_left;
    for (int k = 0; k < 3; ++k) {
      ++directed[{t[k], t[(k + 1) % 3]}];
      used.insert(t[k]);
      parts.join(t[k], t[(k + 1) % 3]);
    }
  }
  PartTopology result;
  int edge_count = 0;
  std::map<int, int> next;
  for (const auto& [edge, uses] : directed) {
    if (uses != 1) result.manifold = false;
    const bool twin = directed.count({edge.second, edge.first}) > 0;
    if (!twin || edge.first < edge.second) ++edge_count;
    if (!twin && !next.emplace(edge.first, edge.second).second) result.manifold = false;
  }
  std::set<int> roots, seen;
  for (const int node : used) roots.insert(parts.find(node));
  for (const auto& [start, unused] : next) {
    if (seen.count(start)) continue;
    ++result.loops;
    for (int node = start; seen.insert(node).second && next.count(node);) node = next[node];
  }
  result.components = int(roots.size());
  result.euler = int(used.size()) - edge_count + faces_left;
  return result;
}

void check_part_topology(const TopoDS_Shape& shape, const ExamplePart& part) {
  const PartTopology found = part_topology(shape, 0.5);
  CHECK(found.manifold);
  CHECK(found.components == part.components);
  CHECK(found.loops == part.loops);
  CHECK(found.euler == part.euler);
}

// The outer trimming loop in (u,v).
std::vector<Vec2> outer_outline(const TopoDS_Face& face) {
  std::vector<Vec2> points;
  for (BRepTools_WireExplorer it(BRepTools::OuterWire(face), face); it.More(); it.Next()) {
    const BRepAdaptor_Curve2d curve(it.Current(), face);
    for (int i = 0; i < 20; ++i) {
      const double t = (it.Current().Orientation() == TopAbs_REVERSED ? 20 - i : i) / 20.0;
      const gp_Pnt2d p = curve.Value(curve.FirstParameter() * (1 - t) + curve.LastParameter() * t);
      points.push_back({p.X(), p.Y()});
    }
  }
  return points;
}

double polygon_area(const std::vector<Vec2>& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    sum += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return sum;
}

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return std::tie(a[0], a[1]) < std::tie(b[0], b[1]); });
  std::vector<Vec2> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Vec2& p : points) {
      while (hull.size() >= start + 2) {
        const Vec2 a = hull[hull.size() - 2], b = hull.back();
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

struct TemporaryFile {
  std::filesystem::path path;
  explicit TemporaryFile(const std::string& name)
      : path(std::filesystem::temp_directory_path() / ("tri_" + std::to_string(std::uintptr_t(this)) + "_" + name)) {}
  ~TemporaryFile() { std::filesystem::remove(path); }
};

// How often each entity type stands in the directory section of an IGES file (two lines an entity, the type in the
// first field).
std::map<int, int> iges_entities(const std::filesystem::path& path) {
  std::map<int, int> types;
  std::ifstream file(path);
  bool first = true;
  for (std::string line; std::getline(file, line);) {
    if (line.size() < 73 || line[72] != 'D') continue;
    if (first) ++types[std::stoi(line.substr(0, 8))];
    first = !first;
  }
  return types;
}

TopoDS_Shape through_file(const Shape& shape, const std::filesystem::path& path) {
  write_cad(path.string(), shape);
  Context context;
  const CadFile file = read_cad(path.string(), context);
  CHECK(file.failed.empty());
  CHECK(file.unit_mm == 1);
  return occt(file.shape);
}

}  // namespace

TEST_CASE("example_parts: every part is valid and has the faces and the topology that its table states") {
  for (const ExamplePart& part : example_parts()) {
    CAPTURE(part.name);
    const Shape shape = example_part(part.name);
    CHECK(BRepCheck_Analyzer(occt(shape)).IsValid());
    CHECK(count(occt(shape), TopAbs_FACE) == part.faces);
    CHECK(count(occt(shape), TopAbs_SHELL) == 1);
    CHECK(count(occt(shape), TopAbs_SOLID) == (part.loops == 0 ? 1 : 0));
    // The flux of the position through all faces: positive for outward normals, as every open part looks away from the
    // origin.
    GProp_GProps flux;
    BRepGProp::VolumeProperties(occt(shape), flux);
    CHECK(flux.Mass() > 0);
    CHECK(ShapeAnalysis_ShapeTolerance().Tolerance(occt(shape), 1) < 0.01);
    check_part_topology(occt(shape), part);
  }
}

TEST_CASE("example_parts: STEP brings every part back with its faces and topology, IGES after sewing") {
  for (const ExamplePart& part : example_parts()) {
    CAPTURE(part.name);
    const Shape shape = example_part(part.name);
    const TemporaryFile step("part.step"), iges("part.igs");
    const TopoDS_Shape from_step = through_file(shape, step.path);
    CHECK(count(from_step, TopAbs_FACE) == part.faces);
    check_part_topology(from_step, part);

    const TopoDS_Shape from_iges = through_file(shape, iges.path);
    CHECK(count(from_iges, TopAbs_FACE) == part.faces);
    check_part_topology(occt(sewn(make_shape(from_iges), 0.01)), part);
  }
}

TEST_CASE("boot-lid: is made of B-spline surfaces only, some of them rational, with concave outlines and inner loops") {
  const Shape lid = example_part("boot-lid");
  int rational = 0, loops = 0, concave = 0;
  for (TopExp_Explorer it(occt(lid), TopAbs_FACE); it.More(); it.Next()) {
    const auto surface = Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(it.Current())));
    REQUIRE(!surface.IsNull());
    rational += surface->IsURational() || surface->IsVRational();
    loops += count(it.Current(), TopAbs_WIRE);
    const std::vector<Vec2> outline = outer_outline(TopoDS::Face(it.Current()));
    concave += std::abs(polygon_area(outline)) < 0.98 * std::abs(polygon_area(convex_hull(outline)));
  }
  CHECK(concave >= 4);  // deck, rear panel, both sides
  CHECK(rational > 0);
  CHECK(rational < 16);
  CHECK(loops == 16 + 2);  // the recess and the lock hole in the rear panel
}

TEST_CASE("boot-lid: as IGES it is 16 loose trimmed NURBS that sew at 0.01 mm into one shell with two free loops") {
  const Shape lid = example_part("boot-lid");
  const TemporaryFile iges("lid.igs");
  const TopoDS_Shape back = through_file(lid, iges.path);
  const std::map<int, int> entities = iges_entities(iges.path);
  CHECK(entities.at(144) == 16);
  CHECK(entities.at(128) == 16);
  CHECK(count(back, TopAbs_FACE) == 16);
  CHECK(count(back, TopAbs_SHELL) == 0);
  const TopoDS_Shape shell = occt(sewn(make_shape(back), 0.01));
  CHECK(count(shell, TopAbs_SHELL) == 1);
  CHECK(part_topology(shell, 0.5).loops == 2);
}

TEST_CASE("example_part: an unknown name is an error that lists the known ones") {
  CHECK_THROWS_WITH_AS(example_part("teapot"), doctest::Contains("fillet-block"), InvalidInput);
  CHECK_THROWS_AS(example_part(""), InvalidInput);
}

TEST_CASE("example_part: two calls share nothing") {
  CHECK_FALSE(occt(example_part("elbow")).IsPartner(occt(example_part("elbow"))));
}
