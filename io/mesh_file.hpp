#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/mesh_view.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// The formats of meshes; `threemf` is 3MF, `gltf` both .gltf and .glb, `vtk` .vtp, which is only written.
enum class MeshFormat { stl, obj, ply, off, threemf, gltf, vtk };
/// How numbers stand in a file; `compressed_text` is 3MF's XML in a ZIP archive.
enum class MeshEncoding { ascii, binary_little_endian, binary_big_endian, compressed_text };

/// "STL", "OBJ", "PLY", "OFF", "3MF", "glTF" or "VTK".
std::string_view name_of(MeshFormat format);
/// "ASCII", "binary little endian", "binary big endian" or "compressed text".
std::string_view name_of(MeshEncoding encoding);

/// What a mesh file held, beside the soup read from it.
struct MeshFileInfo {
  MeshFormat format = MeshFormat::stl;          ///< by content, where the format can be told by it
  MeshEncoding encoding = MeshEncoding::ascii;  ///< how its numbers stand in it
  std::uint64_t bytes = 0;                      ///< size of the file
  std::uint64_t polygons = 0;                   ///< faces in the file that have three corners or more
  std::uint64_t polygons_split = 0;             ///< of these, faces with more than three corners, cut into triangles
  std::vector<std::string> parts;  ///< names of solids, objects and groups, in the order of the file; may hold ""
  /// What the file holds and the soup does not (texture coordinates, materials …), and what was odd: one sentence each.
  std::vector<std::string> notes;
};

/// Reads a triangle mesh from STL, OBJ, PLY, OFF, 3MF or glTF (.gltf and .glb). The content decides about the format,
/// the file name where the content leaves it open.
///
/// Every face is kept, in the order of the file, also degenerate and duplicate ones; a polygon of n corners becomes n-2
/// triangles of its own corners (a fan if it is convex, else by ear clipping). Faces of fewer than three corners cannot
/// be triangles; they are counted in a note. Vertices keep their order and are kept when no face uses them. STL has no
/// shared vertices: corners with identical coordinates (0 and -0 are identical) become one vertex, numbered by first
/// occurrence. Coordinates are the doubles nearest to what the file says.
///
/// From PLY come vertex normals, 8-bit vertex colours, every scalar property of vertices and faces, and the texture
/// coordinates of corners (the list `texcoord` of faces: corner scalars "s" and "t"); from OBJ and OFF vertex colours
/// and normals where each vertex has one, and texture coordinates of corners ("s", "t", NaN where there are none); from
/// OBJ also normals of corners where a vertex has several ("nx", "ny", "nz") and groups, objects and materials (face
/// scalars and labels "group", "object", "material"); from OFF also colours of faces (face scalars "red", "green",
/// "blue", NaN where there are none); from binary STL the two attribute bytes of facets (face scalar "attribute") if
/// any is not 0.
///
/// 3MF and glTF are scenes: every object of the build, or node of the scene, is put where its transforms say, as often
/// as it is named; mirrored ones are turned around, so that their outside stays outside. Objects have the label
/// "object", materials "material". Both state their unit, and coordinates become millimetres: from 3MF by its unit,
/// from glTF, which is in metres by its standard, times 1000; a note says so. Axes stay as they are. 3MF: base
/// materials become colours of faces, colour groups colours of vertices where each has one. glTF: normals, COLOR_0,
/// TEXCOORD_0 ("t" from below, as in OBJ) and attributes of the application ("_NAME": vertex scalar NAME); vertices are
/// those of the file, so that surfaces are cut where it repeats vertices (`weld` joins them).
///
/// @param path file name, or "-" for standard input
/// @param info if given, receives what else is known about the file; `notes` also go to the context's log
/// @throws IoError with line or byte offset: not a mesh, truncated, a coordinate that is not finite, an index out of
/// range, a
///         count in the header that the file cannot hold.
/// @throws Cancelled within some 100,000 elements.
Soup read_mesh(const std::string& path, Context& context, MeshFileInfo* info = nullptr);

/// As `read_mesh`, from bytes in memory. @param name used for messages and, by its extension, for the format.
Soup parse_mesh(std::string_view bytes, const std::string& name, Context& context, MeshFileInfo* info = nullptr);

/// What is to be chosen about a file.
struct MeshWriteOptions {
  bool ascii = false;  ///< text instead of binary, for STL and PLY; the other formats have one encoding each
};

/// What a format could not hold.
struct MeshWriteReport {
  MeshFormat format = MeshFormat::ply;  ///< by the ending of the name
  double max_rounding = 0;  ///< largest change of a coordinate, model units; only binary STL and glTF (floats) round
  std::uint64_t rounded_vertices = 0;  ///< vertices with a coordinate that changed
  std::vector<std::string> notes;      ///< one sentence each: what was rounded or not written
};

/// Writes a mesh in the format that the file name ends in: .stl, .obj, .ply, .off, .3mf, .gltf, .glb or .vtp (any
/// case).
///
/// The file appears whole or not at all. Order of vertices and faces is kept. Text holds the shortest decimal that
/// reads back as the same double, and so does 3MF; binary PLY (little endian) and VTK hold doubles; binary STL and glTF
/// hold floats, in millimetres. PLY: `double x y z`, normals, `point_index cad_face u v deviation` and further scalars
/// by name, `uchar red green blue`; scalars are doubles, but `point_index` and `cad_face` are ints if every value is
/// one. The list `texcoord` of faces holds the corner scalars "s" and "t". The other formats hold what `read_mesh`
/// takes from them; VTK PolyData, which is not read, holds normals, colours and every scalar of vertices and faces.
/// What has no place is named in the notes.
///
/// @param path file name; "-" is not possible, since the format is not known from it
/// @throws InvalidInput if the extension is unknown or the soup is inconsistent (an index out of range, an attribute of
/// the
///         wrong length, a coordinate that is not finite or beyond what the format holds); nothing is written.
/// @throws IoError as `AtomicFile` does.
MeshWriteReport write_mesh(const std::string& path, const Soup& soup, const MeshWriteOptions& options,
                           Context& context);

/// The same for a half-edge mesh: `to_soup(mesh)` is written.
MeshWriteReport write_mesh(const std::string& path, const MeshView& mesh, const MeshWriteOptions& options,
                           Context& context);

}  // namespace tri
