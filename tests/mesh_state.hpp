#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "meshops/editing/change_segment.hpp"

namespace tri::test {

/// Everything in a mesh: links, and all properties of all kinds with slot, name and the bytes of each value. Two states
/// are equal only if the meshes are, bit for bit, with the same handles of elements and of properties.
struct MeshState {
  std::vector<int> links;
  std::vector<std::string> properties;

  bool operator==(const MeshState&) const = default;
};

/// Where two states differ; empty if they are equal.
inline std::string difference(const MeshState& a, const MeshState& b) {
  if (a.links.size() != b.links.size()) return "numbers of links";
  for (std::size_t i = 0; i < a.links.size(); ++i)
    if (a.links[i] != b.links[i])
      return "link " + std::to_string(i) + " of " + std::to_string(a.links[0]) + ", " + std::to_string(a.links[1]) +
             ", " + std::to_string(a.links[2]);
  if (a.properties.size() != b.properties.size()) return "numbers of properties";
  for (std::size_t i = 0; i < a.properties.size(); ++i)
    if (a.properties[i] != b.properties[i]) {
      const std::string &p = a.properties[i], &q = b.properties[i];
      const auto at =
          std::mismatch(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(std::min(p.size(), q.size())), q.begin())
              .first -
          p.begin();
      return p.substr(0, p.find('=')) + " at byte " + std::to_string(at - static_cast<std::ptrdiff_t>(p.find('='))) +
             " of " + std::to_string(p.size()) + " and " + std::to_string(q.size());
    }
  return {};
}

/// The bytes of a value; only for types without padding.
template <class T>
std::string bytes_of(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    return value + '\0';
  } else if constexpr (requires {
                         value.data();
                         value.size();
                       }) {
    std::string all;
    for (int k = 0; k < static_cast<int>(value.size()); ++k) all += bytes_of(value.data()[k]);
    return all + ';';
  } else {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), static_cast<const void*>(&value), sizeof(T));
    return bytes;
  }
}

/// Appends the values if the property is of the type. False if not.
template <class T>
bool append_values(const OpenMesh::BaseProperty& base, std::string& out) {
  const auto* property = dynamic_cast<const OpenMesh::PropertyT<T>*>(&base);
  if (!property) return false;
  for (int i = 0; i < static_cast<int>(property->n_elements()); ++i) {
    const T value = (*property)[i];
    if constexpr (!std::is_empty_v<T>) out += bytes_of(value);
  }
  return true;
}

/// @tparam More  the test's own types of properties
template <class... More, class Kernel>
MeshState state_of(Kernel& kernel) {
  OpenMesh::TriConnectivity& mesh = kernel;
  MeshState s;
  s.links = {static_cast<int>(mesh.n_vertices()), static_cast<int>(mesh.n_edges()), static_cast<int>(mesh.n_faces())};
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i)
    s.links.push_back(mesh.halfedge_handle(VertexHandle(i)).idx());
  for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i) {
    const HalfedgeHandle h(i);
    s.links.insert(s.links.end(), {mesh.to_vertex_handle(h).idx(), mesh.face_handle(h).idx(),
                                   mesh.next_halfedge_handle(h).idx(), mesh.prev_halfedge_handle(h).idx()});
  }
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i)
    s.links.push_back(mesh.halfedge_handle(FaceHandle(i)).idx());
  for (const ElementKind kind : element_kinds) {
    const auto slots = property_slots(mesh, kind);
    for (std::size_t slot = 0; slot < slots.size(); ++slot) {
      if (!slots[slot]) continue;
      const OpenMesh::BaseProperty& p = *slots[slot];
      std::string text = std::to_string(static_cast<int>(kind)) + '/' + std::to_string(slot) + '/' + p.name() + '=';
      const auto any = [&]<class... T>(std::type_identity<T>...) { return (append_values<T>(p, text) || ...); };
      const bool known = any(
          std::type_identity<OpenMesh::Attributes::StatusInfo>(), std::type_identity<bool>(), std::type_identity<int>(),
          std::type_identity<float>(), std::type_identity<double>(), std::type_identity<std::string>(),
          std::type_identity<OpenMesh::Vec2f>(), std::type_identity<OpenMesh::Vec3f>(),
          std::type_identity<OpenMesh::Vec2d>(), std::type_identity<OpenMesh::Vec3d>(),
          std::type_identity<OpenMesh::Vec3uc>(), std::type_identity<OpenMesh::Vec4f>(),
          std::type_identity<std::vector<std::string>>(), std::type_identity<typename Kernel::Point>(),
          std::type_identity<typename Kernel::Normal>(), std::type_identity<typename Kernel::VertexData>(),
          std::type_identity<typename Kernel::EdgeData>(), std::type_identity<typename Kernel::HalfedgeData>(),
          std::type_identity<typename Kernel::FaceData>(), std::type_identity<More>()...);
      if (!known) text += "UNKNOWN TYPE";
      s.properties.push_back(std::move(text));
    }
  }
  return s;
}

}  // namespace tri::test
