#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <string>
#include <vector>

namespace editor {

/// The editor's own kernel: float positions, and colours that the library knows nothing of.
struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3f;
  using Normal = OpenMesh::Vec3f;
  using Color = OpenMesh::Vec3uc;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};
using EditorMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/// The editor's own face property: the number of the brush a face was painted with, 0 for none. Operators carry it to
/// the faces they make.
inline constexpr const char* brush_property = "editor:brush";

}  // namespace editor
