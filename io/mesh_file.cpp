#include "io/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/input_file.hpp"
#include "io/mesh_formats/mesh_formats.hpp"
#include "io/mesh_formats/mesh_losses.hpp"
#include "io/text_scanner.hpp"
#include "meshops/to_soup.hpp"

namespace tri {
namespace {

using namespace io_detail;

bool begins_with_word(std::string_view bytes, std::string_view word) {
  return bytes.starts_with(word) && bytes.size() > word.size() &&
         (TextScanner::blank(bytes[word.size()]) || TextScanner::line_end(bytes[word.size()]));
}

// True if the first line that is no comment begins as a line of an OBJ file does.
bool looks_like_obj(std::string_view bytes) {
  const std::string file;
  TextScanner scanner(bytes.substr(0, 1 << 16), file);
  if (!scanner.next_filled_line('#')) return false;
  const std::string_view word = scanner.token();
  for (const char* keyword : {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"})
    if (word == keyword) return true;
  return false;
}

[[noreturn]] void fail_unknown(std::string_view bytes, const std::string& name) {
  std::string what = "is not a mesh in STL, OBJ, PLY, OFF, 3MF or glTF";
  if (bytes.starts_with("ISO-10303-21")) what += "; it is a STEP file, a CAD model";
  if (bytes.starts_with("\x1f\x8b")) what += "; it is compressed";
  if (bytes.find("<VTKFile") < 200 || bytes.starts_with("# vtk")) what += "; it is a VTK file, which is written only";
  if (bytes.starts_with("# .PCD")) what += "; it is a PCD file, a set of points";
  throw IoError(name, what);
}

MeshFormat format_of(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("PK\x03\x04") || bytes.starts_with("PK\x05\x06")) return MeshFormat::threemf;
  if (bytes.starts_with("glTF")) return MeshFormat::gltf;
  if (begins_with_word(bytes, "ply")) return MeshFormat::ply;
  if (has_binary_stl_size(bytes)) return MeshFormat::stl;
  if (has_off_header(bytes)) return MeshFormat::off;
  const std::string extension = file_extension(name);
  const std::string_view text = bytes.substr(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  if (begins_with_word(text, "solid") && extension != "obj") return MeshFormat::stl;
  if (extension == "stl") return MeshFormat::stl;
  if (extension == "obj") return MeshFormat::obj;
  if (extension == "ply") return MeshFormat::ply;
  if (extension == "off") return MeshFormat::off;
  if (extension == "gltf" || extension == "glb" || looks_like_gltf(bytes)) return MeshFormat::gltf;
  if (extension == "3mf") return MeshFormat::threemf;
  if (looks_like_obj(bytes)) return MeshFormat::obj;
  fail_unknown(bytes, name);
}

void check_length(std::size_t size, std::size_t wanted, const std::string& what, bool may_be_empty) {
  if (size != wanted && !(may_be_empty && size == 0))
    throw InvalidInput(fmt::format("{} has {} values for {} elements", what, size, wanted));
}

void check_finite(const std::vector<Vec3>& vectors, const char* what) {
  for (std::size_t i = 0; i < vectors.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(vectors[i][k])) throw InvalidInput(fmt::format("{} {} is not finite", what, i));
}

void check_scalars(const std::map<std::string, std::vector<double>>& scalars, std::size_t count,
                   const std::string& element, const std::vector<std::string>& taken) {
  for (const auto& [name, values] : scalars) {
    check_length(values.size(), count, fmt::format("{} scalar \"{}\"", element, name), false);
    const bool printable = std::all_of(name.begin(), name.end(), [](char c) { return c > ' ' && c < 127; });
    if (name.empty() || !printable)
      throw InvalidInput(fmt::format("{} scalar \"{}\": the name must be printable, without blanks", element, name));
    if (std::find(taken.begin(), taken.end(), name) != taken.end())
      throw InvalidInput(fmt::format("{} scalar \"{}\": the name is taken", element, name));
  }
}

void check(const Soup& soup) {
  const std::size_t n = soup.points.size();
  check_finite(soup.points, "vertex");
  check_finite(soup.vertex_normals, "the normal of vertex");
  check_length(soup.vertex_normals.size(), n, "vertex_normals", true);
  check_length(soup.vertex_colors.size(), n, "vertex_colors", true);
  std::vector<std::string> taken{"x", "y", "z"};
  if (!soup.vertex_normals.empty()) taken.insert(taken.end(), {"nx", "ny", "nz"});
  if (!soup.vertex_colors.empty()) taken.insert(taken.end(), {"red", "green", "blue"});
  check_scalars(soup.vertex_scalars, n, "vertex", taken);
  check_scalars(soup.face_scalars, soup.triangles.size(), "face", {"vertex_indices", "vertex_index", "texcoord"});
  check_scalars(soup.corner_scalars, 3 * soup.triangles.size(), "corner", {});
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (const std::uint32_t v : soup.triangles[i])
      if (v >= n) throw InvalidInput(fmt::format("triangle {} names vertex {} of {}", i, v, n));
}

struct Ending {
  const char* extension;
  MeshFormat format;
};
constexpr Ending endings[] = {{"stl", MeshFormat::stl},  {"obj", MeshFormat::obj},     {"ply", MeshFormat::ply},
                              {"off", MeshFormat::off},  {"3mf", MeshFormat::threemf}, {"gltf", MeshFormat::gltf},
                              {"glb", MeshFormat::gltf}, {"vtp", MeshFormat::vtk}};

MeshFormat output_format(const std::string& path) {
  const std::string extension = file_extension(path);
  for (const Ending& ending : endings)
    if (extension == ending.extension) return ending.format;
  throw InvalidInput(fmt::format(
      "{}: meshes are written as .stl, .obj, .ply, .off, .3mf, .gltf, .glb or .vtp, not \".{}\"", path, extension));
}

#ifndef TRI_WITH_3MF
constexpr const char* without_3mf = "this program was built without 3MF (libzip and expat)";
#endif

}  // namespace

std::string_view name_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::stl:
      return "STL";
    case MeshFormat::obj:
      return "OBJ";
    case MeshFormat::ply:
      return "PLY";
    case MeshFormat::off:
      return "OFF";
    case MeshFormat::threemf:
      return "3MF";
    case MeshFormat::gltf:
      return "glTF";
    case MeshFormat::vtk:
      break;
  }
  return "VTK";
}

std::string_view name_of(MeshEncoding encoding) {
  switch (encoding) {
    case MeshEncoding::ascii:
      return "ASCII";
    case MeshEncoding::binary_little_endian:
      return "binary little endian";
    case MeshEncoding::binary_big_endian:
      return "binary big endian";
    case MeshEncoding::compressed_text:
      break;
  }
  return "compressed text";
}

Soup parse_mesh(std::string_view bytes, const std::string& name, Context& context, MeshFileInfo* info) {
  MeshFileInfo own;
  MeshFileInfo& what = info ? *info : own;
  what = {};
  what.bytes = bytes.size();
  if (bytes.empty()) throw IoError(name, "is empty");
  if (bytes.starts_with("\xEF\xBB\xBF") && !has_binary_stl_size(bytes)) bytes.remove_prefix(3);  // the mark of UTF-8
  Soup soup;
  switch (format_of(bytes, name)) {
    case MeshFormat::stl:
      soup = parse_stl(bytes, name, context, what);
      break;
    case MeshFormat::obj:
      soup = parse_obj(bytes, name, context, what);
      break;
    case MeshFormat::ply:
      soup = parse_ply(bytes, name, context, what);
      break;
    case MeshFormat::off:
      soup = parse_off(bytes, name, context, what);
      break;
    case MeshFormat::threemf:
#ifdef TRI_WITH_3MF
      soup = parse_threemf(bytes, name, context, what);
      break;
#else
      throw IoError(name, without_3mf);
#endif
    case MeshFormat::gltf:
      soup = parse_gltf(bytes, name, context, what);
      break;
    case MeshFormat::vtk:
      fail_unknown(bytes, name);
  }
  for (const std::string& note : what.notes) context.log(name + ": " + note);
  context.progress("read", 1);
  return soup;
}

Soup read_mesh(const std::string& path, Context& context, MeshFileInfo* info) {
  const InputFile file(path);
  return parse_mesh(file.bytes(), file.name(), context, info);
}

MeshWriteReport write_mesh(const std::string& path, const Soup& soup, const MeshWriteOptions& options,
                           Context& context) {
  MeshWriteReport report;
  report.format = output_format(path);
#ifndef TRI_WITH_3MF
  if (report.format == MeshFormat::threemf) throw InvalidInput(fmt::format("{}: {}", path, without_3mf));
#endif
  check(soup);
  note_what_is_lost(soup, options.ascii, report);

  AtomicFile file(path);
  switch (report.format) {
    case MeshFormat::stl:
      write_stl(file, soup, options.ascii, context, report);
      break;
    case MeshFormat::obj:
      write_obj(file, soup, context, report);
      break;
    case MeshFormat::ply:
      write_ply(file, soup, options.ascii, context);
      break;
    case MeshFormat::off:
      write_off(file, soup, context);
      break;
    case MeshFormat::threemf:
#ifdef TRI_WITH_3MF
      write_threemf(file, soup, context, report);
#endif
      break;
    case MeshFormat::gltf:
      write_gltf(file, soup, file_extension(path) == "glb", context, report);
      break;
    case MeshFormat::vtk:
      write_vtp(file, soup, context);
      break;
  }
  file.commit();
  for (const std::string& note : report.notes) context.log(path + ": " + note);
  context.progress("write", 1);
  return report;
}

MeshWriteReport write_mesh(const std::string& path, const MeshView& mesh, const MeshWriteOptions& options,
                           Context& context) {
  return write_mesh(path, to_soup(mesh), options, context);
}

}  // namespace tri
