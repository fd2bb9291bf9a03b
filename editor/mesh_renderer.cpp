#include "mesh_renderer.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace editor {
namespace {

constexpr const char* face_vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 view, projection;
out vec3 seen;
out vec3 corner;
void main() {
  vec4 p = view * vec4(position, 1);
  seen = p.xyz;
  int k = gl_VertexID % 3;
  corner = vec3(k == 0, k == 1, k == 2);
  gl_Position = projection * p;
})";

// Backs are drawn reddish: an inside-out part is seen at a glance. Identifiers are the face's number plus 1.
constexpr const char* face_fragment_shader = R"(#version 330 core
in vec3 seen;
in vec3 corner;
uniform usamplerBuffer marks;
uniform bool edges;
layout(location = 0) out vec4 color;
layout(location = 1) out uint id;
const vec3 brushes[4] = vec3[](vec3(0.62, 0.68, 0.74), vec3(0.45, 0.70, 0.50), vec3(0.72, 0.60, 0.80), vec3(0.85, 0.78, 0.45));
void main() {
  uint mark = texelFetch(marks, gl_PrimitiveID).r;
  vec3 base = brushes[(mark >> 1) & 3u];
  if (!gl_FrontFacing) base = vec3(0.62, 0.36, 0.34);
  if ((mark & 1u) != 0u) base = mix(base, vec3(1.0, 0.55, 0.10), 0.75);
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float light = 0.30 + 0.70 * abs(dot(normal, normalize(vec3(0.25, 0.35, 1.0))));
  vec3 c = base * light;
  if (edges) {
    vec3 width = fwidth(corner);
    vec3 a = smoothstep(vec3(0), width * 1.2, corner);
    // Where triangles are smaller than pixels, lines would paint everything black.
    float fade = clamp(1.0 - 2.5 * max(width.x, max(width.y, width.z)), 0.0, 1.0);
    c = mix(c, c * 0.45, (1.0 - min(a.x, min(a.y, a.z))) * fade);
  }
  color = vec4(c, 1);
  id = uint(gl_PrimitiveID) + 1u;
})";

constexpr const char* line_vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 view, projection;
void main() {
  gl_Position = projection * view * vec4(position, 1);
  gl_Position.z -= 1e-4 * gl_Position.w;  // in front of the faces it bounds
})";

constexpr const char* line_fragment_shader = R"(#version 330 core
layout(location = 0) out vec4 color;
void main() { color = vec4(0.95, 0.15, 0.15, 1); })";

unsigned compile(const char* vertex, const char* fragment) {
  const unsigned program = glCreateProgram();
  for (const auto& [kind, source] :
       {std::pair{GLenum{GL_VERTEX_SHADER}, vertex}, std::pair{GLenum{GL_FRAGMENT_SHADER}, fragment}}) {
    const unsigned shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  int linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked) {
    std::array<char, 1024> text{};
    glGetProgramInfoLog(program, text.size(), nullptr, text.data());
    throw std::runtime_error("the graphics driver does not take a shader: " + std::string(text.data()));
  }
  return program;
}

using Corners = std::array<OpenMesh::Vec3f, 3>;

Corners corners_of(const EditorMesh& mesh, OpenMesh::FaceHandle f) {
  Corners c{OpenMesh::Vec3f(0, 0, 0), OpenMesh::Vec3f(0, 0, 0), OpenMesh::Vec3f(0, 0, 0)};
  if (mesh.status(f).deleted()) return c;
  OpenMesh::HalfedgeHandle h = mesh.halfedge_handle(f);
  for (auto& p : c) {
    p = mesh.point(mesh.to_vertex_handle(h));
    h = mesh.next_halfedge_handle(h);
  }
  return c;
}

void set_camera(unsigned program, const Camera& camera, float width_by_height) {
  glUseProgram(program);
  const Matrix4 view = camera.view(), projection = camera.projection(width_by_height);
  glUniformMatrix4fv(glGetUniformLocation(program, "view"), 1, GL_FALSE, view.data());
  glUniformMatrix4fv(glGetUniformLocation(program, "projection"), 1, GL_FALSE, projection.data());
}

}  // namespace

MeshRenderer::MeshRenderer() {
  program_ = compile(face_vertex_shader, face_fragment_shader);
  line_program_ = compile(line_vertex_shader, line_fragment_shader);
  for (auto [array, buffer] : {std::pair{&vertex_array_, &corners_}, std::pair{&boundary_array_, &boundary_}}) {
    glGenVertexArrays(1, array);
    glGenBuffers(1, buffer);
    glBindVertexArray(*array);
    glBindBuffer(GL_ARRAY_BUFFER, *buffer);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 3 * sizeof(float), nullptr);
    glEnableVertexAttribArray(0);
  }
  glGenBuffers(1, &marks_);
  glGenTextures(1, &marks_texture_);
  glGenFramebuffers(1, &frame_);
  for (unsigned* texture : {&color_, &ids_, &depth_}) glGenTextures(1, texture);
}

MeshRenderer::~MeshRenderer() {
  for (const unsigned texture : {color_, ids_, depth_, marks_texture_}) glDeleteTextures(1, &texture);
  for (const unsigned buffer : {corners_, marks_, boundary_}) glDeleteBuffers(1, &buffer);
  for (const unsigned array : {vertex_array_, boundary_array_}) glDeleteVertexArrays(1, &array);
  glDeleteFramebuffers(1, &frame_);
  glDeleteProgram(program_);
  glDeleteProgram(line_program_);
}

void MeshRenderer::reserve(std::size_t faces) {
  capacity_ = faces;
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(capacity_ * sizeof(Corners)), nullptr, GL_DYNAMIC_DRAW);
}

void MeshRenderer::send_all(const EditorMesh& mesh) {
  faces_ = mesh.n_faces();
  std::vector<Corners> corners(faces_);
  for (std::size_t i = 0; i < faces_; ++i) corners[i] = corners_of(mesh, OpenMesh::FaceHandle(static_cast<int>(i)));
  reserve(faces_ + faces_ / 8 + 64);  // room for what operators add
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(faces_ * sizeof(Corners)), corners.data());
  send_boundary(mesh);
  send_marks(mesh);
}

void MeshRenderer::send_faces(const EditorMesh& mesh, std::span<const OpenMesh::FaceHandle> faces) {
  if (mesh.n_faces() > capacity_) return send_all(mesh);
  faces_ = mesh.n_faces();
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  for (const OpenMesh::FaceHandle f : faces) {
    if (!mesh.is_valid_handle(f)) continue;  // an added face that was taken back
    const Corners corners = corners_of(mesh, f);
    glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(f.idx() * sizeof(Corners)), sizeof(Corners), &corners);
  }
  send_boundary(mesh);
  send_marks(mesh);
}

void MeshRenderer::send_marks(const EditorMesh& mesh) {
  OpenMesh::FPropHandleT<int> brush;
  const bool painted = mesh.get_property_handle(brush, brush_property);
  std::vector<std::uint8_t> marks(std::max<std::size_t>(mesh.n_faces(), 1));
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) {
    const OpenMesh::FaceHandle f(static_cast<int>(i));
    marks[i] =
        static_cast<std::uint8_t>(mesh.status(f).selected() | (painted ? (mesh.property(brush, f) & 3) << 1 : 0));
  }
  glBindBuffer(GL_TEXTURE_BUFFER, marks_);
  glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(marks.size()), marks.data(), GL_DYNAMIC_DRAW);
  glBindTexture(GL_TEXTURE_BUFFER, marks_texture_);
  glTexBuffer(GL_TEXTURE_BUFFER, GL_R8UI, marks_);
}

void MeshRenderer::send_boundary(const EditorMesh& mesh) {
  std::vector<OpenMesh::Vec3f> ends;
  for (std::size_t i = 0; i < mesh.n_edges(); ++i) {
    const OpenMesh::EdgeHandle e(static_cast<int>(i));
    if (mesh.status(e).deleted() || !mesh.is_boundary(e)) continue;
    for (const unsigned side : {0U, 1U})
      ends.push_back(mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(e, side))));
  }
  boundary_vertices_ = ends.size();
  glBindBuffer(GL_ARRAY_BUFFER, boundary_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(ends.size() * sizeof(ends[0])), ends.data(), GL_DYNAMIC_DRAW);
}

void MeshRenderer::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  struct Target {
    unsigned texture;
    GLint internal;
    GLenum format, type, attachment;
  };
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  for (const Target& t :
       {Target{color_, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_COLOR_ATTACHMENT0},
        Target{ids_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, GL_COLOR_ATTACHMENT1},
        Target{depth_, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, GL_DEPTH_ATTACHMENT}}) {
    glBindTexture(GL_TEXTURE_2D, t.texture);
    glTexImage2D(GL_TEXTURE_2D, 0, t.internal, width, height, 0, t.format, t.type, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glFramebufferTexture2D(GL_FRAMEBUFFER, t.attachment, GL_TEXTURE_2D, t.texture, 0);
  }
}

unsigned MeshRenderer::draw(const Camera& camera, int width, int height, const Style& style) {
  resize(width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_);
  const std::array<GLenum, 2> both{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glDrawBuffers(2, both.data());
  glViewport(0, 0, width, height);
  glEnable(GL_DEPTH_TEST);
  const std::array<float, 4> background{0.13F, 0.14F, 0.16F, 1};
  const std::array<GLuint, 4> nothing{0, 0, 0, 0};
  const float far = 1;
  glClearBufferfv(GL_COLOR, 0, background.data());
  glClearBufferuiv(GL_COLOR, 1, nothing.data());
  glClearBufferfv(GL_DEPTH, 0, &far);
  const float aspect = static_cast<float>(width) / static_cast<float>(std::max(height, 1));
  if (faces_ > 0) {
    set_camera(program_, camera, aspect);
    glUniform1i(glGetUniformLocation(program_, "edges"), style.edges);
    glUniform1i(glGetUniformLocation(program_, "marks"), 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_BUFFER, marks_texture_);
    glBindVertexArray(vertex_array_);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(3 * faces_));
  }
  if (style.boundary && boundary_vertices_ > 0) {
    glDrawBuffers(1, both.data());
    set_camera(line_program_, camera, aspect);
    glBindVertexArray(boundary_array_);
    glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(boundary_vertices_));
  }
  glDisable(GL_DEPTH_TEST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return color_;
}

std::vector<OpenMesh::FaceHandle> MeshRenderer::faces_in(const PixelBox& box) const {
  const int left = std::clamp(box.x, 0, width_), right = std::clamp(box.x + box.width, 0, width_);
  const int top = std::clamp(box.y, 0, height_), bottom = std::clamp(box.y + box.height, 0, height_);
  if (left >= right || top >= bottom) return {};
  std::vector<std::uint32_t> ids(static_cast<std::size_t>(right - left) * static_cast<std::size_t>(bottom - top));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_);
  glReadBuffer(GL_COLOR_ATTACHMENT1);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(left, height_ - bottom, right - left, bottom - top, GL_RED_INTEGER, GL_UNSIGNED_INT, ids.data());
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<OpenMesh::FaceHandle> faces;
  for (const std::uint32_t id : ids)
    if (id > 0) faces.emplace_back(static_cast<int>(id - 1));
  return faces;
}

}  // namespace editor
