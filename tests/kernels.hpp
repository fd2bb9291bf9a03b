#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// After the traits that it specialises.
#include <OpenMesh/Core/Geometry/EigenVectorT.hh>
#include <string>
#include <vector>

#include "meshops/mesh.hpp"

namespace tri::test {

/// An editor's kernel: float points, attributes and traits of its own.
struct EditorTraits : OpenMesh::DefaultTraits {
  VertexAttributes(OpenMesh::Attributes::Normal | OpenMesh::Attributes::Color | OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status |
                     OpenMesh::Attributes::TexCoord2D);
  FaceAttributes(OpenMesh::Attributes::Normal | OpenMesh::Attributes::Status);
  VertexTraits { int tag = -1; };
};
using EditorKernel = OpenMesh::TriMesh_ArrayKernelT<EditorTraits>;

/// OpenMesh's default kernel: float points, no status.
using BareKernel = OpenMesh::TriMesh_ArrayKernelT<>;

struct EigenTraits : OpenMesh::DefaultTraits {
  using Point = Eigen::Vector3d;
  using Normal = Eigen::Vector3d;
  FaceAttributes(OpenMesh::Attributes::Status);
};
using EigenKernel = OpenMesh::TriMesh_ArrayKernelT<EigenTraits>;

/// The same surface in another kernel, with attributes of zero. Deleted elements do not come along.
template <class Kernel>
void copy_mesh(const Mesh& source, Kernel& mesh) {
  using Point = typename Kernel::Point;
  using Scalar = std::remove_cvref_t<decltype(std::declval<Point&>()[0])>;
  for (std::size_t i = 0; i < source.n_vertices(); ++i) {
    const Vec3 p = source.point(VertexHandle(static_cast<int>(i)));
    mesh.add_vertex(Point(static_cast<Scalar>(p[0]), static_cast<Scalar>(p[1]), static_cast<Scalar>(p[2])));
  }
  for (const FaceHandle f : source.faces()) {
    std::vector<VertexHandle> corners;
    for (const VertexHandle v : source.fv_range(f)) corners.push_back(v);
    mesh.add_face(corners);
  }
  if (mesh.has_vertex_normals())
    for (const VertexHandle v : mesh.vertices()) mesh.set_normal(v, typename Kernel::Normal(0, 0, 0));
  if (mesh.has_vertex_colors())
    for (const VertexHandle v : mesh.vertices()) mesh.set_color(v, typename Kernel::Color(0, 0, 0));
  if (mesh.has_face_normals())
    for (const FaceHandle f : mesh.faces()) mesh.set_normal(f, typename Kernel::Normal(0, 0, 0));
  if (mesh.has_halfedge_texcoords2D())
    for (const HalfedgeHandle h : mesh.halfedges()) mesh.set_texcoord2D(h, typename Kernel::TexCoord2D(0, 0));
}

/// Properties of every kind with values that differ from element to element.
template <class Kernel>
void add_properties(Kernel& mesh) {
  OpenMesh::VPropHandleT<int> id;
  OpenMesh::VPropHandleT<std::string> name;
  OpenMesh::VPropHandleT<float> weight;
  OpenMesh::EPropHandleT<double> crease;
  OpenMesh::EPropHandleT<bool> marked;
  OpenMesh::HPropHandleT<OpenMesh::Vec2f> texture;
  OpenMesh::HPropHandleT<int> flow;
  OpenMesh::FPropHandleT<OpenMesh::Vec3uc> color;
  OpenMesh::FPropHandleT<std::string> label;
  mesh.add_property(id, "editor:id");
  mesh.add_property(name, "editor:name");
  mesh.add_property(weight, "editor:weight");
  mesh.add_property(crease, "editor:crease");
  mesh.add_property(marked, "editor:marked");
  mesh.add_property(texture, "h:editor_texture");
  mesh.add_property(flow, "editor:flow");
  mesh.add_property(color, "editor:color");
  mesh.add_property(label, "f:label");
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i) {
    const VertexHandle v(i);
    mesh.property(id, v) = 100 + i;
    mesh.property(name, v) = "vertex " + std::to_string(i);
    mesh.property(weight, v) = 0.1f * static_cast<float>(i);
  }
  for (int i = 0; i < static_cast<int>(mesh.n_edges()); ++i) {
    mesh.property(crease, EdgeHandle(i)) = 0.5 * i;
    mesh.property(marked, EdgeHandle(i)) = i % 3 == 0;
  }
  for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i) {
    mesh.property(texture, HalfedgeHandle(i)) = OpenMesh::Vec2f(static_cast<float>(i), 0.25f);
    mesh.property(flow, HalfedgeHandle(i)) = -i;
  }
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i) {
    mesh.property(color, FaceHandle(i)) = OpenMesh::Vec3uc(static_cast<unsigned char>(i), 7, 9);
    mesh.property(label, FaceHandle(i)) = "face " + std::to_string(i);
  }
}

}  // namespace tri::test
