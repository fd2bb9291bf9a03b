#include "meshops/editing/change_segment.hpp"

namespace tri {
namespace {

template <class Iterator>
std::span<OpenMesh::BaseProperty*> span_of(Iterator begin, Iterator end) {
  return begin == end ? std::span<OpenMesh::BaseProperty*>()
                      : std::span(&*begin, static_cast<std::size_t>(end - begin));
}

}  // namespace

std::span<OpenMesh::BaseProperty*> property_slots(OpenMesh::TriConnectivity& mesh, ElementKind kind) {
  switch (kind) {
    case ElementKind::vertex:
      return span_of(mesh.vprops_begin(), mesh.vprops_end());
    case ElementKind::edge:
      return span_of(mesh.eprops_begin(), mesh.eprops_end());
    case ElementKind::halfedge:
      return span_of(mesh.hprops_begin(), mesh.hprops_end());
    case ElementKind::face:
      return span_of(mesh.fprops_begin(), mesh.fprops_end());
    case ElementKind::mesh:
      return span_of(mesh.mprops_begin(), mesh.mprops_end());
  }
  return {};
}

}  // namespace tri
