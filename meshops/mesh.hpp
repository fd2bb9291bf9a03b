#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "meshops/vec.hpp"

namespace tri {

struct MeshTraits : OpenMesh::DefaultTraits {
  using Point = Vec3;
  using Normal = Vec3;
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};

/// The default kernel: double positions and status attributes.
using Mesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;

using VertexHandle = OpenMesh::VertexHandle;
using EdgeHandle = OpenMesh::EdgeHandle;
using HalfedgeHandle = OpenMesh::HalfedgeHandle;
using FaceHandle = OpenMesh::FaceHandle;

/// Names of the vertex properties that tie a triangulated mesh to its points and its CAD model.
namespace property {
inline constexpr const char* point_index = "v:point_index";  ///< int, 0-based index of the measured point; -1 for a synthetic vertex
inline constexpr const char* cad_face = "v:cad_face";        ///< int, 1-based face of the model; 0 for none
inline constexpr const char* uv = "v:uv";                    ///< Vec2, parameters on that face's own surface
inline constexpr const char* deviation = "v:deviation";      ///< double, mm, positive outside
}  // namespace property

}  // namespace tri
