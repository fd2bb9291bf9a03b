#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "camera.hpp"
#include "editor_mesh.hpp"

namespace editor {

/// Rectangle in pixels of the drawing area; y grows downwards.
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Draws the faces of a mesh into a texture, and tells which face is under a pixel.
///
/// Each face has its own three corners in the buffer, at the place of its handle; so a changed face is sent alone, and
/// a deleted one becomes a point. Needs a current OpenGL 3.3 context for as long as it lives.
class MeshRenderer {
 public:
  MeshRenderer();
  ~MeshRenderer();
  MeshRenderer(const MeshRenderer&) = delete;
  MeshRenderer& operator=(const MeshRenderer&) = delete;

  /// Sends every face.
  void send_all(const EditorMesh& mesh);
  /// Sends these faces; the mesh may have more faces than before, or fewer.
  void send_faces(const EditorMesh& mesh, std::span<const OpenMesh::FaceHandle> faces);
  /// Sends which faces are selected and how they are painted: a byte per face, cheap.
  void send_marks(const EditorMesh& mesh);

  struct Style {
    bool edges = true;
    bool boundary = true;
  };
  /// Draws into a texture of this size. @return the texture's name in OpenGL, the bottom row first
  unsigned draw(const Camera& camera, int width, int height, const Style& style);

  /// The faces seen in a box of the last picture, each once, in increasing order.
  std::vector<OpenMesh::FaceHandle> faces_in(const PixelBox& box) const;

 private:
  void resize(int width, int height);
  void reserve(std::size_t faces);
  void send_boundary(const EditorMesh& mesh);

  int width_ = 0, height_ = 0;
  std::size_t faces_ = 0, capacity_ = 0, boundary_vertices_ = 0;
  unsigned program_ = 0, line_program_ = 0;
  unsigned frame_ = 0, color_ = 0, ids_ = 0, depth_ = 0;
  unsigned vertex_array_ = 0, corners_ = 0, marks_ = 0, marks_texture_ = 0;
  unsigned boundary_array_ = 0, boundary_ = 0;
};

}  // namespace editor
