#include "meshops/soup_on_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "meshops/build_mesh.hpp"
#include "meshops/editing/change_recorder.hpp"
#include "meshops/editing/change_set.hpp"
#include "meshops/editing/mesh_edit.hpp"
#include "meshops/editing/new_values.hpp"
#include "meshops/error.hpp"
#include "meshops/limits.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/closest_on_triangle.hpp"
#include "meshops/soup_edit.hpp"
#include "meshops/to_soup.hpp"

namespace tri {
namespace {

// Scalars by which elements are known again; no attribute of a user has a name with a space at its end.
constexpr const char* vertex_mark = "vertex of the mesh ";
constexpr const char* face_mark = "face of the mesh ";

std::size_t slot_of(OpenMesh::BaseHandle handle) {
  return static_cast<std::size_t>(handle.idx());
}

using Corners = std::array<VertexHandle, 3>;

Corners vertices_of(const OpenMesh::TriConnectivity& mesh, FaceHandle f) {
  const HalfedgeHandle h = mesh.halfedge_handle(f), next = mesh.next_halfedge_handle(h);
  return {mesh.to_vertex_handle(h), mesh.to_vertex_handle(next),
          mesh.to_vertex_handle(mesh.next_halfedge_handle(next))};
}

bool same_cycle(const Corners& a, const Corners& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (a[0] == b[k] && a[1] == b[(k + 1) % 3] && a[2] == b[(k + 2) % 3]) return true;
  return false;
}

/// The selected part of a mesh as a soup, marked.
Soup marked_part(MeshView view, const Context& context) {
  Pace pace(context);
  const auto& mesh = view.mesh;
  Soup soup = to_soup(view, &context);
  auto& vertex = soup.vertex_scalars[vertex_mark];
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i, pace())
    if (!mesh.status(VertexHandle(static_cast<int>(i))).deleted()) vertex.push_back(static_cast<double>(i));
  auto& face = soup.face_scalars[face_mark];
  for (std::size_t i = 0; i < mesh.n_faces(); ++i, pace())
    if (!mesh.status(FaceHandle(static_cast<int>(i))).deleted()) face.push_back(static_cast<double>(i));
  if (!view.selection) return soup;

  std::vector<char> keep(soup.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t, pace())
    keep[t] = view.may_replace(FaceHandle(static_cast<int>(face[t])));
  keep_triangles(soup, keep, &context);
  std::vector<std::uint32_t> number(soup.points.size(), dropped_point);
  std::uint32_t count = 0;
  for (const Triangle& t : soup.triangles)
    for (const std::uint32_t v : t) number[v] = 0;
  for (std::uint32_t& n : number)
    if (n == 0) n = count++;
  renumber_points(soup, number, count, &context);
  return soup;
}

/// What a mark says: the index, or `no_index` where the operator mixed marks or made the element from nothing.
std::uint32_t read_mark(double mark, std::size_t count) {
  return mark >= 0 && mark < static_cast<double>(count) && mark == std::floor(mark) ? static_cast<std::uint32_t>(mark)
                                                                                    : no_index;
}

/// Puts what became of the part into the mesh.
class Replacement {
 public:
  Replacement(MeshView view, const Mesh& made, Report& report, const Context& context)
      : view_(view), mesh_(view.mesh), made_(made), report_(report), context_(context), pace_(context),
        vertices_(mesh_.n_vertices()), faces_(mesh_.n_faces()) {
    require_property(vertex_of_, std::string("v:") + vertex_mark);
    require_property(face_of_, std::string("f:") + face_mark);
  }

  /// @param in_part  of each vertex of the mesh: whether it went into the soup
  /// @throws Cancelled, half done
  void run(const std::vector<char>& in_part) {
    match_vertices();
    match_faces();
    delete_old(in_part);
    place_vertices();
    add_new();
  }

 private:
  template <class Handle>
  void require_property(Handle& handle, const std::string& name) {
    if (!made_.get_property_handle(handle, name))
      throw InvalidInput("the operator took the marks of the elements away");
  }

  /// Vertices where they were come first, then those that moved; each vertex of the mesh is taken once.
  void match_vertices() {
    handle_.assign(made_.n_vertices(), VertexHandle());
    taken_.assign(vertices_, 0);
    for (const bool moved : {false, true})
      for (std::size_t i = 0; i < made_.n_vertices(); ++i, pace_()) {
        const VertexHandle w(static_cast<int>(i));
        const std::uint32_t mark = read_mark(made_.property(vertex_of_, w), vertices_);
        if (mark == no_index || taken_[mark] || handle_[i].is_valid()) continue;
        const VertexHandle v(static_cast<int>(mark));
        if (moved ? !view_.may_move(v) : view_.point(v) != made_.point(w)) continue;
        handle_[i] = v;
        taken_[mark] = 1;
        if (moved) moved_.push_back(w);
      }
  }

  void match_faces() {
    stays_.assign(faces_, 0);
    for (std::size_t i = 0; i < made_.n_faces(); ++i, pace_()) {
      const FaceHandle g(static_cast<int>(i));
      const std::uint32_t mark = read_mark(made_.property(face_of_, g), faces_);
      const Corners now = vertices_of(made_, g);
      const bool known = mark != no_index && !stays_[mark] &&
                         same_cycle({handle_[slot_of(now[0])], handle_[slot_of(now[1])], handle_[slot_of(now[2])]},
                                    vertices_of(mesh_, FaceHandle(static_cast<int>(mark))));
      if (known)
        stays_[mark] = 1;
      else
        new_faces_.push_back(g);
    }
  }

  void delete_old(const std::vector<char>& in_part) {
    // What new elements inherit from deleted ones is looked up before.
    for (const FaceHandle g : new_faces_) {
      pace_();
      for (const VertexHandle w : vertices_of(made_, g))
        if (!handle_[slot_of(w)].is_valid()) sources_.emplace(slot_of(w), sources_of(w, g));
    }
    for (std::size_t i = 0; i < faces_; ++i, pace_()) {
      const FaceHandle f(static_cast<int>(i));
      if (stays_[i] || mesh_.status(f).deleted() || !view_.may_replace(f)) continue;
      delete_face(view_, f);
      report_.touched_faces.push_back(static_cast<std::uint32_t>(i));
    }
    double parted = 0;
    for (std::size_t i = 0; i < vertices_; ++i, pace_()) {
      const VertexHandle v(static_cast<int>(i));
      if (!in_part[i] || taken_[i] || mesh_.status(v).deleted()) continue;
      if (mesh_.is_isolated(v)) {
        delete_vertex(view_, v);
      } else {
        ++parted;
      }
    }
    if (parted > 0) report_.figures["parted at the rim"] = parted;
  }

  std::vector<VertexSource> sources_of(VertexHandle w, FaceHandle g) const {
    const std::uint32_t copy = read_mark(made_.property(vertex_of_, w), vertices_);
    if (copy != no_index && view_.point(VertexHandle(static_cast<int>(copy))) == made_.point(w))
      return {{VertexHandle(static_cast<int>(copy)), 1}};
    const std::uint32_t face = read_mark(made_.property(face_of_, g), faces_);
    if (face == no_index) return {};
    const Corners c = vertices_of(mesh_, FaceHandle(static_cast<int>(face)));
    const auto weights = barycentric(made_.point(w), view_.point(c[0]), view_.point(c[1]), view_.point(c[2]));
    return {{c[0], weights[0]}, {c[1], weights[1]}, {c[2], weights[2]}};
  }

  /// Of the point of a triangle that is closest, by areas; a third each where the triangle has none.
  static std::array<double, 3> barycentric(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 q = closest_on_triangle({a, b, c}, p);
    std::array<double, 3> w{((b - q) % (c - q)).norm(), ((c - q) % (a - q)).norm(), ((a - q) % (b - q)).norm()};
    const double sum = w[0] + w[1] + w[2];
    for (double& x : w) x = sum > 0 ? x / sum : 1.0 / 3;
    return w;
  }

  void place_vertices() {
    for (const VertexHandle w : moved_) {
      pace_();
      set_point(view_, handle_[slot_of(w)], made_.point(w));
      report_.touched_vertices.push_back(static_cast<std::uint32_t>(handle_[slot_of(w)].idx()));
    }
    for (std::size_t i = 0; i < made_.n_vertices(); ++i, pace_()) {
      if (handle_[i].is_valid()) continue;
      const auto known = sources_.find(i);
      handle_[i] = add_vertex(view_, made_.point(VertexHandle(static_cast<int>(i))),
                              known == sources_.end() ? std::vector<VertexSource>() : known->second);
      report_.touched_vertices.push_back(static_cast<std::uint32_t>(handle_[i].idx()));
    }
  }

  void add_new() {
    std::vector<VertexTriple> triples;
    for (const FaceHandle g : new_faces_) {
      pace_();
      const Corners c = vertices_of(made_, g);
      triples.push_back({handle_[slot_of(c[0])], handle_[slot_of(c[1])], handle_[slot_of(c[2])]});
    }
    std::vector<FaceHandle> added;
    if (const FitResult fit = add_faces(view_, triples, &added, &context_); fit != FitResult::fits)
      throw InvalidInput("what the operator made of the selection does not fit to the faces around it (" +
                         std::string(to_string(fit)) + "); select more of the mesh");
    for (std::size_t i = 0; i < added.size(); ++i, pace_()) {
      report_.touched_faces.push_back(static_cast<std::uint32_t>(added[i].idx()));
      if (const std::uint32_t mark = read_mark(made_.property(face_of_, new_faces_[i]), faces_); mark != no_index)
        inherit(added[i], FaceHandle(static_cast<int>(mark)));
      copy_corners(new_faces_[i], added[i]);
    }
  }

  void inherit(FaceHandle piece, FaceHandle whole) {
    inherit_values(view_, ElementKind::face, whole, piece);
    mesh_.status(piece).set_selected(mesh_.status(whole).selected());
  }

  /// Corner values that the soup carried, to the corners of the same vertices.
  void copy_corners(FaceHandle from, FaceHandle to) {
    for (auto it = made_.hprops_begin(); it != made_.hprops_end(); ++it) {
      const auto* source = dynamic_cast<const OpenMesh::PropertyT<double>*>(*it);
      if (!source || !source->name().starts_with("h:")) continue;
      OpenMesh::HPropHandleT<double> as_double;
      OpenMesh::HPropHandleT<float> as_float;
      const bool doubles = mesh_.get_property_handle(as_double, source->name());
      if (!doubles && !mesh_.get_property_handle(as_float, source->name())) continue;
      HalfedgeHandle h = made_.halfedge_handle(from);
      for (int k = 0; k < 3; ++k, h = made_.next_halfedge_handle(h)) {
        HalfedgeHandle g = mesh_.halfedge_handle(to);
        while (mesh_.to_vertex_handle(g) != handle_[slot_of(made_.to_vertex_handle(h))])
          g = mesh_.next_halfedge_handle(g);
        const double value = (*source)[h.idx()];
        about_to_set(view_, g);
        if (doubles)
          mesh_.property(as_double, g) = value;
        else
          mesh_.property(as_float, g) = static_cast<float>(value);
      }
    }
  }

  MeshView view_;
  OpenMesh::TriConnectivity& mesh_;
  const Mesh& made_;
  Report& report_;
  const Context& context_;
  Pace pace_;
  const std::size_t vertices_, faces_;  ///< of the mesh before
  OpenMesh::VPropHandleT<double> vertex_of_;
  OpenMesh::FPropHandleT<double> face_of_;
  std::vector<VertexHandle> handle_;  ///< in the mesh, of each vertex that was made
  std::vector<char> taken_, stays_;   ///< of each vertex and face of the mesh
  std::vector<VertexHandle> moved_;   ///< of what was made
  std::vector<FaceHandle> new_faces_;
  std::map<std::size_t, std::vector<VertexSource>> sources_;
};

}  // namespace

Report run_on_mesh(const std::function<Report(Soup&)>& op, MeshView view, Context& context) {
  Soup soup = marked_part(view, context);
  std::vector<char> in_part(view.mesh.n_vertices(), 0);
  for (const double v : soup.vertex_scalars.at(vertex_mark)) in_part[static_cast<std::size_t>(v)] = 1;
  Report report = op(soup);
  report.touched_vertices.clear();
  report.touched_faces.clear();
  report.maps = {};
  if (report.unchanged()) return report;
  const BuiltMesh built = build_mesh(soup, context);
  context.checkpoint();
  for (const auto& [reason, count] : built.report.skipped) report.skipped[reason] += count;
  report.notes.insert(report.notes.end(), built.report.notes.begin(), built.report.notes.end());
  // Recorded, so that a part that does not fit, or a cancel, leaves the mesh as it was.
  ChangeRecorder recorder(view);
  try {
    Replacement(recorder.view(), built.mesh, report, context).run(in_part);
  } catch (...) {
    recorder.roll_back();
    throw;
  }
  return report;
}

}  // namespace tri
