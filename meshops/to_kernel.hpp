#pragma once

#include <OpenMesh/Core/Utils/color_cast.hh>
#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "meshops/mesh.hpp"

namespace tri {

/// Fills a mesh of any OpenMesh triangle kernel with another: an editor's with what `build_mesh` made of a file.
///
/// Elements come in the same order, elements marked as deleted included. Positions, normals and colours are converted
/// to the kernel's own types (doubles are rounded to floats where it has floats), and attributes that only the source
/// has are requested, status attributes always. Properties named "v:…", "e:…", "h:…", "f:…" and "m:…" come along.
/// Properties that only the target has stay, with default values; one of the same name becomes a copy of the source's.
/// O(elements).
/// @param target  its elements are dropped; handles to them become invalid, handles to its properties stay valid unless
///   the source has one of that name
template <class Kernel>
void to_kernel(const Mesh& source, Kernel& target) {
  static_assert(std::is_base_of_v<OpenMesh::TriConnectivity, Kernel>,
                "tri works on triangle meshes: use an OpenMesh::TriMesh_ArrayKernelT");
  target.clear();
  target.assign_connectivity(source);
  // OpenMesh copies what a status marks, not the status itself.
  if (!target.has_vertex_status()) target.request_vertex_status();
  if (!target.has_edge_status()) target.request_edge_status();
  if (!target.has_halfedge_status()) target.request_halfedge_status();
  if (!target.has_face_status()) target.request_face_status();
  for (const VertexHandle v : source.all_vertices()) target.status(v) = source.status(v);
  for (const EdgeHandle e : source.all_edges()) target.status(e) = source.status(e);
  for (const HalfedgeHandle h : source.all_halfedges()) target.status(h) = source.status(h);
  for (const FaceHandle f : source.all_faces()) target.status(f) = source.status(f);
  const auto for_vertices = [&](const auto& action) {
    for (std::size_t i = 0; i < source.n_vertices(); ++i) action(VertexHandle(static_cast<int>(i)));
  };
  using Point = typename Kernel::Point;
  using Scalar = std::remove_cvref_t<decltype(std::declval<Point&>()[0])>;
  for_vertices([&](VertexHandle v) {
    for (int k = 0; k < 3; ++k) target.point(v)[k] = static_cast<Scalar>(source.point(v)[static_cast<std::size_t>(k)]);
  });
  if (source.has_vertex_normals()) {
    if (!target.has_vertex_normals()) target.request_vertex_normals();
    for_vertices([&](VertexHandle v) {
      typename Kernel::Normal n = target.normal(v);
      for (int k = 0; k < 3; ++k)
        n[k] = static_cast<std::remove_cvref_t<decltype(n[0])>>(source.normal(v)[static_cast<std::size_t>(k)]);
      target.set_normal(v, n);
    });
  }
  if (source.has_vertex_colors()) {
    if (!target.has_vertex_colors()) target.request_vertex_colors();
    for_vertices(
        [&](VertexHandle v) { target.set_color(v, OpenMesh::color_cast<typename Kernel::Color>(source.color(v))); });
  }

  const auto is_attribute = [](const std::string& name) {  // done above, or nothing that could be found again
    return name.empty() || name.front() == '<' || name == "v:points" || name == "v:normals" || name == "v:colors" ||
           (name.size() == 8 && name.compare(2, 6, "status") == 0);
  };
  const auto copy = [&](auto from, auto from_end, const auto& slots, const auto& add) {
    for (; from != from_end; ++from) {
      if (!*from || is_attribute((*from)->name())) continue;
      std::unique_ptr<OpenMesh::BaseProperty> own((*from)->clone());
      const auto [begin, end] = slots();
      const auto there = std::find_if(begin, end, [&](auto* p) { return p && p->name() == own->name(); });
      if (there == end) {
        add(own.release());
      } else {
        delete std::exchange(*there, own.release());
      }
    }
  };
  copy(
      source.vprops_begin(), source.vprops_end(), [&] { return std::pair(target.vprops_begin(), target.vprops_end()); },
      [&](auto* p) { target._add_vprop(p); });
  copy(
      source.eprops_begin(), source.eprops_end(), [&] { return std::pair(target.eprops_begin(), target.eprops_end()); },
      [&](auto* p) { target._add_eprop(p); });
  copy(
      source.hprops_begin(), source.hprops_end(), [&] { return std::pair(target.hprops_begin(), target.hprops_end()); },
      [&](auto* p) { target._add_hprop(p); });
  copy(
      source.fprops_begin(), source.fprops_end(), [&] { return std::pair(target.fprops_begin(), target.fprops_end()); },
      [&](auto* p) { target._add_fprop(p); });
  copy(
      source.mprops_begin(), source.mprops_end(), [&] { return std::pair(target.mprops_begin(), target.mprops_end()); },
      [&](auto* p) { target._add_mprop(p); });
}

}  // namespace tri
