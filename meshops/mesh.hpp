#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "meshops/vec.hpp"

namespace tri {

/// What the default kernel is made of.
struct MeshTraits : OpenMesh::DefaultTraits {
  using Point = Vec3;   ///< positions in double precision
  using Normal = Vec3;  ///< and normals, where they are requested
  VertexAttributes(OpenMesh::Attributes::Status);
  EdgeAttributes(OpenMesh::Attributes::Status);
  HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge | OpenMesh::Attributes::Status);
  FaceAttributes(OpenMesh::Attributes::Status);
};

/// The default kernel: double positions and status attributes.
using Mesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;

using VertexHandle = OpenMesh::VertexHandle;  ///< 0-based index of a vertex; -1 is none
using EdgeHandle = OpenMesh::EdgeHandle;      ///< of an edge, whose half-edges are 2 i and 2 i + 1
/// Of a half-edge, the side of an edge that belongs to the face on its left
using HalfedgeHandle = OpenMesh::HalfedgeHandle;
using FaceHandle = OpenMesh::FaceHandle;  ///< of a face

/// Names of the vertex properties that tie a triangulated mesh to its points and its CAD model.
namespace property {
inline constexpr const char* point_index = "v:point_index";  ///< int, 0-based index of the measured point; -1 for a
                                                             ///< synthetic vertex
inline constexpr const char* cad_face = "v:cad_face";        ///< int, 1-based face of the model; 0 for none
inline constexpr const char* uv = "v:uv";                    ///< Vec2, parameters on that face's own surface
inline constexpr const char* deviation = "v:deviation";      ///< double, mm, positive outside
}  // namespace property

}  // namespace tri
