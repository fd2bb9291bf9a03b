#include "libtri/triangulation/shell/insertion.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libtri/quiet_context.hpp"
#include "libtri/triangulation/delaunay.hpp"
#include "libtri/triangulation/shell/triangle_geometry.hpp"
#include "meshops/error.hpp"
#include "meshops/limits.hpp"

namespace tri {
namespace {

using Barycentric = std::array<double, 3>;

/// Feet keep this share of a triangle's height away from its sides, so that the hull of a triangle's points is the
/// triangle.
constexpr double inset = 1e-6;
/// Across the edge of the trimmed polygon a foot may land outside it; it is taken in this deep.
constexpr double outside_inset = 1e-3;

Barycentric barycentric(const std::array<Vec2, 3>& t, const Vec2& q) {
  const Vec2 e = t[1] - t[0], f = t[2] - t[0], d = q - t[0];
  const double area = e[0] * f[1] - e[1] * f[0];
  if (area == 0) return {-1, -1, -1};
  const double b = (d[0] * f[1] - d[1] * f[0]) / area, c = (e[0] * d[1] - e[1] * d[0]) / area;
  return {1 - b - c, b, c};
}

/// Closest point of a triangle in space, as barycentric coordinates [Ericson 2005, 5.1.5].
Barycentric closest(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab | ap, d2 = ac | ap;
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = ab | bp, d4 = ac | bp;
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vec3 cp = p - c;
  const double d5 = ab | cp, d6 = ac | cp;
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

void keep_inside(Barycentric& l, double margin) {
  double sum = 0;
  for (double& x : l) sum += x = std::max(x, margin);
  for (double& x : l) x /= sum;
}

/// Finds a triangle of one face at a (u,v): a uniform grid over the triangles' parameter boxes.
class FaceLocator {
 public:
  void add(std::int32_t triangle) { triangles_.push_back(triangle); }

  void build(const Tessellation& mesh) {
    mesh_ = &mesh;
    lo_ = Vec2(1, 1) * infinity;
    Vec2 hi = -lo_;
    for (std::int32_t t : triangles_)
      for (const Vec2& q : mesh.corner_uv[t]) lo_.minimize(q), hi.maximize(q);
    const double cells = std::max(1.0, 2.0 * static_cast<double>(triangles_.size()));
    side_ = std::max(1, static_cast<int>(std::sqrt(cells)));
    for (int k = 0; k < 2; ++k) scale_[k] = hi[k] > lo_[k] ? side_ / (hi[k] - lo_[k]) : 0;
    start_.assign(static_cast<std::size_t>(side_ * side_) + 1, 0);
    for (int pass = 0; pass < 2; ++pass) {
      if (pass == 1) {
        for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
        items_.resize(start_.back());
      }
      for (std::int32_t t : triangles_) {
        int box[4];
        cells_of(mesh.corner_uv[t], box);
        for (int y = box[1]; y <= box[3]; ++y)
          for (int x = box[0]; x <= box[2]; ++x) {
            if (pass == 0) {
              ++start_[y * side_ + x];
            } else {
              items_[--start_[y * side_ + x]] = t;
            }
          }
      }
    }
  }

  /// @return the triangle that holds (u,v), else one that is near, else -1
  std::int32_t find(const Vec2& q, Barycentric& l) const {
    if (triangles_.empty()) return -1;
    const int cell = cell_of(q, 1) * side_ + cell_of(q, 0);
    std::int32_t best = -1;
    double least_outside = -infinity;
    for (std::uint32_t i = start_[cell]; i < start_[cell + 1]; ++i) {
      l = barycentric(mesh_->corner_uv[items_[i]], q);
      const double outside = std::min({l[0], l[1], l[2]});
      if (outside >= 0) return items_[i];
      if (outside > least_outside) least_outside = outside, best = items_[i];
    }
    return best;
  }

  std::int32_t find_nearest(const Vec3& p, Barycentric& l) const {
    std::int32_t best = -1;
    double best_distance = infinity;
    for (std::int32_t t : triangles_) {
      const Triangle& q = mesh_->triangles[t];
      const Barycentric x = closest(mesh_->points[q[0]], mesh_->points[q[1]], mesh_->points[q[2]], p);
      const Vec3 on = mesh_->points[q[0]] * x[0] + mesh_->points[q[1]] * x[1] + mesh_->points[q[2]] * x[2];
      const double distance = (on - p).sqrnorm();
      if (distance < best_distance) best_distance = distance, best = t, l = x;
    }
    return best;
  }

 private:
  int cell_of(const Vec2& q, int axis) const {
    const double x = (q[axis] - lo_[axis]) * scale_[axis];
    return x > 0 ? std::min(static_cast<int>(std::min(x, 1e9)), side_ - 1) : 0;
  }
  void cells_of(const std::array<Vec2, 3>& t, int box[4]) const {
    Vec2 lo = t[0], hi = t[0];
    for (const Vec2& q : t) lo.minimize(q), hi.maximize(q);
    box[0] = cell_of(lo, 0), box[1] = cell_of(lo, 1), box[2] = cell_of(hi, 0), box[3] = cell_of(hi, 1);
  }

  const Tessellation* mesh_ = nullptr;
  std::vector<std::int32_t> triangles_;
  Vec2 lo_{0, 0}, scale_{0, 0};
  int side_ = 1;
  std::vector<std::uint32_t> start_;
  std::vector<std::int32_t> items_;
};

struct Place {
  std::int32_t triangle = -1;
  Barycentric l{};
};

/// Barycentric coordinates of the orthogonal projection on the triangle's plane; not all positive outside the triangle.
Barycentric projected(const Tessellation& mesh, std::int32_t t, const Vec3& p) {
  const Triangle& q = mesh.triangles[t];
  const Vec3 e = mesh.points[q[1]] - mesh.points[q[0]], f = mesh.points[q[2]] - mesh.points[q[0]],
             d = p - mesh.points[q[0]];
  const double ee = e | e, ff = f | f, ef = e | f, de = d | e, df = d | f;
  const double det = ee * ff - ef * ef;
  if (!(det > 0)) return {-1, -1, -1};
  const double b = (de * ff - df * ef) / det, c = (df * ee - de * ef) / det;
  return {1 - b - c, b, c};
}

/// Walks over one face from `start` to the triangle that the foot projects into. (u,v) alone would bend the order of
/// the points where the parameters run unevenly, most of all at a pole.
Place settle(const Tessellation& mesh, std::int32_t start, const Vec3& p) {
  constexpr int longest_walk = 64;
  Place place;
  std::int32_t previous = -1, t = start;
  for (int step = 0; step < longest_walk; ++step) {
    place.triangle = t;
    place.l = projected(mesh, t, p);
    int out = -1;
    double deepest = 0;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = mesh.neighbors[t][k];
      if (place.l[k] < deepest && n >= 0 && n != previous && mesh.faces[n] == mesh.faces[t])
        deepest = place.l[k], out = k;
    }
    if (out < 0) return place;
    previous = t;
    t = mesh.neighbors[t][out];
  }
  place.triangle = -1;
  return place;
}

std::vector<Place> locate(const CadModel& model, const Tessellation& mesh, std::span<const Foot> feet,
                          Context& context) {
  std::vector<FaceLocator> locators(model.faces.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) locators[mesh.faces[t]].add(static_cast<std::int32_t>(t));
  for (FaceLocator& l : locators) l.build(mesh);
  std::vector<Place> places(feet.size());
  context.checkpoint();
  const auto locate_range = [&](const tbb::blocked_range<std::size_t>& range) {
    context.checkpoint();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Foot& foot = feet[i];
      if (foot.face < 0) continue;
      Place& place = places[i];
      const std::int32_t start = locators[foot.face].find(foot.uv, place.l);
      if (start >= 0) place = settle(mesh, start, foot.point);
      if (place.triangle >= 0) {
        const Triangle& q = mesh.triangles[place.triangle];
        const Vec3 &a = mesh.points[q[0]], &b = mesh.points[q[1]], &c = mesh.points[q[2]];
        const bool inside = place.l[0] >= 0 && place.l[1] >= 0 && place.l[2] >= 0;
        if (!inside) place.l = closest(a, b, c, foot.point);
        // Wrong parameter curves may have led to the wrong end of the face.
        const double away = (a * place.l[0] + b * place.l[1] + c * place.l[2] - foot.point).sqrnorm();
        if (away > 9 * mesh.deflection * mesh.deflection) place.triangle = -1;
        keep_inside(place.l, inside ? inset : outside_inset);
      }
      if (place.triangle < 0) {
        place.triangle = locators[foot.face].find_nearest(foot.point, place.l);
        keep_inside(place.l, outside_inset);
      }
    }
  };
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] { tbb::parallel_for(tbb::blocked_range<std::size_t>(0, feet.size(), 4096), locate_range); });
  return places;
}

/// The sub-triangles of one original triangle and, per side, the sub-triangle that holds it.
class TriangleFiller {
 public:
  TriangleFiller(const Tessellation& mesh, EditMesh& out, const std::vector<std::uint32_t>& start,
                 const std::vector<std::uint32_t>& order, const std::vector<Place>& places,
                 const std::vector<std::uint32_t>& vertex_of)
      : mesh_(mesh), out_(out), start_(start), order_(order), places_(places), vertex_of_(vertex_of) {}

  /// First sub-triangle of original triangle `t`: n points inside give 2n + 1.
  std::size_t base(std::size_t t) const { return t + 2 * std::size_t{start_[t]}; }

  void fill(std::size_t t, std::array<std::int32_t, 3>& sides, Context& context) const {
    const Triangle& q = mesh_.triangles[t];
    const std::size_t n = start_[t + 1] - start_[t];
    const auto first = static_cast<std::int32_t>(base(t));
    if (n == 0) {
      out_.triangles[first] = q;
      sides = {first, first, first};
      return;
    }
    const Vec3 a = mesh_.points[q[0]], ab = mesh_.points[q[1]] - a, ac = mesh_.points[q[2]] - a;
    const double length = ab.norm();
    const double along = length > 0 ? (ab | ac) / length : 0;
    const double height = std::sqrt(std::max(0.0, ac.sqrnorm() - along * along));
    std::array<Vec2, 3> frame{Vec2(0, 0), Vec2(length, 0), Vec2(along, height)};
    // A needle of the tessellation is opened to a triangle that the planar predicates can work in.
    if (!(height > 1e-9 * length)) frame = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    std::vector<Vec2> points(frame.begin(), frame.end());
    std::vector<Barycentric> l(n);
    for (std::size_t i = 0; i < n; ++i) {
      l[i] = places_[order_[start_[t] + i]].l;
      points.push_back(frame[0] * l[i][0] + frame[1] * l[i][1] + frame[2] * l[i][2]);
    }
    Delaunay d = delaunay(points, context);
    // Points measured twice share a foot: they are spread a little, each a different way, until all are in.
    for (double step = 1e-7; d.triangles.size() != 2 * n + 1 && step < 0.1; step *= 8) {
      for (std::size_t i = 0; i < n; ++i) {
        const double angle = 2.399963229728653 * static_cast<double>(i + 1);
        Barycentric x = l[i];
        x[0] += step * std::cos(angle);
        x[1] += step * std::sin(angle);
        x[2] -= step * (std::cos(angle) + std::sin(angle));
        keep_inside(x, std::min(0.2, 4 * step));
        points[3 + i] = frame[0] * x[0] + frame[1] * x[1] + frame[2] * x[2];
      }
      d = delaunay(points, context);
    }
    if (d.triangles.size() != 2 * n + 1)
      throw CadError("points inside one triangle of the tessellation cannot be told apart");
    const auto global = [&](std::uint32_t i) { return i < 3 ? q[i] : vertex_of_[order_[start_[t] + i - 3]]; };
    for (std::size_t i = 0; i < d.triangles.size(); ++i) {
      const auto id = first + static_cast<std::int32_t>(i);
      for (int k = 0; k < 3; ++k) {
        out_.triangles[id][k] = global(d.triangles[i][k]);
        out_.neighbors[id][k] = d.neighbors[i][k] < 0 ? -1 : first + d.neighbors[i][k];
        if (d.neighbors[i][k] >= 0) continue;
        const std::uint32_t from = d.triangles[i][(k + 1) % 3], to = d.triangles[i][(k + 2) % 3];
        for (std::uint32_t side = 0; side < 3; ++side)
          if (from == (side + 1) % 3 && to == (side + 2) % 3) sides[side] = id;
      }
    }
  }

 private:
  const Tessellation& mesh_;
  EditMesh& out_;
  const std::vector<std::uint32_t>& start_;
  const std::vector<std::uint32_t>& order_;
  const std::vector<Place>& places_;
  const std::vector<std::uint32_t>& vertex_of_;
};

/// Normals of the tessellation's vertices; zero where its triangles disagree, which is at the model's sharp edges.
void set_tessellation_normals(const Tessellation& mesh, std::vector<EditMesh::Vertex>& vertices) {
  std::vector<Vec3> unit(mesh.triangles.size());
  std::vector<Vec3> sum(mesh.points.size(), Vec3(0, 0, 0));
  const auto corner = [&](const Triangle& t, int k) -> const Vec3& { return mesh.points[t[k]]; };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    unit[i] = unit_normal(corner(t, 0), corner(t, 1), corner(t, 2));
    for (std::uint32_t v : t) sum[v] += unit[i];
  }
  std::vector<bool> sharp(mesh.points.size(), false);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::uint32_t v : mesh.triangles[i])
      if ((unit[i] | sum[v]) < std::cos(sharp_angle) * sum[v].norm()) sharp[v] = true;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    const double length = sum[v].norm();
    if (sharp[v] || length == 0) continue;
    for (int k = 0; k < 3; ++k) vertices[v].normal[k] = static_cast<float>(sum[v][k] / length);
  }
}

void split_double_edges(EditMesh& mesh) {
  struct Edge {
    std::uint32_t a, b;
    std::int32_t triangle;
  };
  std::vector<Edge> edges;
  const auto from_model = [&](std::uint32_t v) { return mesh.vertices[v].point < 0; };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
      // Each edge once: from its lower end, or from its only side.
      if ((a < b || mesh.neighbors[t][k] < 0) && from_model(a) && from_model(b))
        edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t)});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return x.a != y.a ? x.a < y.a : x.b != y.b ? x.b < y.b : x.triangle < y.triangle;
  });
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    if (e.a != edges[i - 1].a || e.b != edges[i - 1].b) continue;
    for (int k = 0; k < 3; ++k) {
      const Triangle& q = mesh.triangles[e.triangle];
      if (std::min(q[(k + 1) % 3], q[(k + 2) % 3]) != e.a || std::max(q[(k + 1) % 3], q[(k + 2) % 3]) != e.b) continue;
      EditMesh::Vertex middle;
      middle.p = (mesh.vertices[e.a].p + mesh.vertices[e.b].p) * 0.5;
      mesh.split_edge(e.triangle, k, middle);
      break;
    }
  }
}

}  // namespace

EditMesh insert_feet(const CadModel& model, const Tessellation& mesh, std::span<const Foot> feet, Context& context) {
  const std::vector<Place> places = locate(model, mesh, feet, context);
  context.checkpoint();
  std::vector<std::uint32_t> start(mesh.triangles.size() + 1, 0);
  for (const Place& p : places)
    if (p.triangle >= 0) ++start[p.triangle + 1];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) start[t + 1] += start[t];
  std::vector<std::uint32_t> order(start.back()), fill(start.begin(), start.end() - 1);
  for (std::uint32_t i = 0; i < places.size(); ++i)
    if (places[i].triangle >= 0) order[fill[places[i].triangle]++] = i;

  context.checkpoint();
  EditMesh out;
  out.vertices.resize(mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v) out.vertices[v].p = mesh.points[v];
  set_tessellation_normals(mesh, out.vertices);
  std::vector<std::uint32_t> vertex_of(feet.size(), 0);
  out.vertices.reserve(mesh.points.size() + order.size());
  for (std::uint32_t i = 0; i < feet.size(); ++i) {
    if (places[i].triangle < 0) continue;
    vertex_of[i] = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.push_back({feet[i].point, feet[i].normal, 0, static_cast<std::int32_t>(i)});
  }
  const std::size_t n_triangles = mesh.triangles.size() + 2 * order.size();
  out.triangles.resize(n_triangles);
  out.neighbors.assign(n_triangles, {-1, -1, -1});
  out.creases.assign(n_triangles, 0);

  context.checkpoint();
  std::vector<std::array<std::int32_t, 3>> sides(mesh.triangles.size());
  const TriangleFiller filler(mesh, out, start, order, places, vertex_of);
  tbb::task_arena arena(context.threads > 0 ? context.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t t) {
      QuietContext quiet(context, 1);
      filler.fill(t, sides[t], quiet);
    });
  });

  const auto normal_of = [&](std::int32_t t) {
    const Triangle& q = mesh.triangles[t];
    return unit_normal(mesh.points[q[0]], mesh.points[q[1]], mesh.points[q[2]]);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t n = mesh.neighbors[t][k];
      if (n < 0) continue;
      int m = 0;
      while (mesh.neighbors[n][m] != static_cast<std::int32_t>(t) ||
             mesh.triangles[n][(m + 1) % 3] != mesh.triangles[t][(k + 2) % 3])
        ++m;
      const std::int32_t inner = sides[t][k];
      const std::uint32_t a = mesh.triangles[t][(k + 1) % 3];
      const int corner = (out.corner(inner, a) + 2) % 3;
      out.neighbors[inner][corner] = sides[n][m];
      if ((normal_of(static_cast<std::int32_t>(t)) | normal_of(n)) < std::cos(sharp_angle))
        out.creases[inner] |= static_cast<std::uint8_t>(1u << corner);
    }
  context.checkpoint();
  out.index_vertices();
  context.checkpoint();
  split_double_edges(out);
  context.checkpoint();
  return out;
}

}  // namespace tri
