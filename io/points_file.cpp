#include "io/points_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/atomic_file.hpp"
#include "io/input_file.hpp"
#include "io/mesh_file.hpp"
#include "io/mesh_formats/mesh_formats.hpp"
#include "io/point_formats/points_formats.hpp"
#include "io/point_formats/points_writer.hpp"
#include "meshops/error.hpp"
#include "meshops/points/point_soup.hpp"

namespace tri {
namespace {

using namespace io_detail;

bool is_iges(std::string_view bytes) {
  // Lines of 80 columns; column 73 names the section, the first of which is S.
  return bytes.size() > 80 && bytes[72] == 'S' &&
         bytes.substr(73, 7).find_first_not_of(" 01") == std::string_view::npos;
}

void refuse_other_kinds(std::string_view bytes, const std::string& name) {
  const auto refuse = [&name](const std::string& what) {
    throw IoError(name, "is not a text, PTX, PLY, PCD or E57 file of points: " + what);
  };
  if (bytes.starts_with("ISO-10303-21") || is_iges(bytes)) refuse("it is a CAD model");
  if (bytes.starts_with("LASF")) refuse("LAS is not read");
  if (bytes.starts_with("\x1f\x8b") || bytes.starts_with("PK\x03\x04")) refuse("it is compressed");
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) refuse("it is UTF-16 text");
  const std::size_t zero = bytes.substr(0, 1 << 16).find('\0');
  if (zero != std::string_view::npos)
    throw IoError(name, "is not a text, PTX, PLY, PCD or E57 file of points: it holds binary data", IoError::Unit::byte,
                  zero);
}

PointSet from_mesh(std::string_view bytes, const std::string& name, Context& context, PointsFileInfo& info) {
  MeshFileInfo mesh;
  Context quiet;  // the notes are logged once, by the caller; cancelling still has to reach the reader
  quiet.threads = context.threads;
  quiet.on_progress = [&context, &quiet](std::string_view step, double share) {
    context.progress(step, share);
    if (context.cancelled()) quiet.cancel();
  };
  context.checkpoint();
  Soup soup = parse_mesh(bytes, name, quiet, &mesh);
  info.format = mesh.format == MeshFormat::ply ? PointsFormat::ply : PointsFormat::mesh;
  info.notes = std::move(mesh.notes);
  if (!soup.triangles.empty())
    info.notes.push_back(
        fmt::format("{} triangles were left out: their vertices are the points", soup.triangles.size()));
  return to_points(std::move(soup));
}

}  // namespace

PointSet parse_points(std::string_view bytes, const std::string& name, Context& context, PointsFileInfo* info) {
  PointsFileInfo own;
  PointsFileInfo& what = info ? *info : own;
  what = {};
  what.bytes = bytes.size();
  if (bytes.empty()) throw IoError(name, "is empty");
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);  // the mark of UTF-8
  const std::string extension = file_extension(name);
  const bool ply = bytes.starts_with("ply") && bytes.size() > 3 && (bytes[3] == '\n' || bytes[3] == '\r');
  PointSet set;
  static constexpr std::string_view meshes[] = {"ply", "stl", "obj", "off", "3mf", "gltf", "glb"};
  if (ply || std::find(std::begin(meshes), std::end(meshes), extension) != std::end(meshes)) {
    set = from_mesh(bytes, name, context, what);
  } else if (has_pcd_header(bytes) || extension == "pcd") {
    set = parse_pcd(bytes, name, context, what);
  } else if (bytes.starts_with("ASTM-E57")) {
    set = parse_e57(bytes, name, context, what);
  } else if (extension == "ptx" || has_ptx_header(bytes)) {
    set = parse_ptx(bytes, name, context, what);
  } else {
    refuse_other_kinds(bytes, name);
    if (extension == "e57") throw IoError(name, "is no E57 file: it does not begin with ASTM-E57");
    set = parse_points_text(bytes, name, context, what);
  }
  if (set.points.empty()) throw IoError(name, "holds no point");
  for (const std::string& note : what.notes) context.log(name + ": " + note);
  context.progress("read", 1);
  return set;
}

PointSet read_points(const std::string& path, Context& context, PointsFileInfo* info) {
  const InputFile file(path);
  return parse_points(file.bytes(), file.name(), context, info);
}

void write_points(const std::string& path, const PointSet& set, Context& context) {
  const std::string extension = file_extension(path);
  if (std::find(points_extensions.begin(), points_extensions.end(), extension) == points_extensions.end())
    throw InvalidInput(fmt::format("{}: points are written as .{}, not \".{}\"", path,
                                   fmt::join(points_extensions, ", ."), extension));
  validate(set);
  if (extension == "ply") {
    write_mesh(path, to_soup(set), {}, context);
    return;
  }
  AtomicFile file(path);
  if (extension == "pcd")
    write_pcd(file, set, context);
  else
    write_points_text(file, set, extension == "csv" ? ',' : ' ', extension == "csv", context);
  file.commit();
  context.progress("write", 1);
}

}  // namespace tri
