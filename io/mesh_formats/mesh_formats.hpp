#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.hpp"
#include "io/mesh_file.hpp"

// The formats behind io/mesh_file.hpp. Readers fill `info` except for `bytes`, and throw as `read_mesh` does; writers
// expect a soup that was checked and leave `commit` to the caller.
namespace tri::io_detail {

Soup parse_stl(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info);
Soup parse_obj(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info);
Soup parse_ply(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info);
Soup parse_off(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info);
Soup parse_gltf(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info);

void write_stl(AtomicFile& file, const Soup& soup, bool ascii, Context& context, MeshWriteReport& report);
void write_obj(AtomicFile& file, const Soup& soup, Context& context, MeshWriteReport& report);
void write_ply(AtomicFile& file, const Soup& soup, bool ascii, Context& context);
void write_off(AtomicFile& file, const Soup& soup, Context& context);
/// @param binary GLB; else JSON with the numbers in base 64
void write_gltf(AtomicFile& file, const Soup& soup, bool binary, Context& context, MeshWriteReport& report);
void write_vtp(AtomicFile& file, const Soup& soup, Context& context);

// With libzip and expat only (TRI_WITH_3MF).
Soup parse_threemf(std::string_view bytes, const std::string& file, Context& context, MeshFileInfo& info);
void write_threemf(AtomicFile& file, const Soup& soup, Context& context, MeshWriteReport& report);

/// Whether these values fit the two attribute bytes of a binary STL facet.
bool is_stl_attribute(const std::vector<double>& values);

/// True if the size is exactly what the facet count of a binary STL header asks for (at least one facet).
bool has_binary_stl_size(std::string_view bytes);
/// True for the magic of GLB, and for JSON that names an "asset" in its first 64 KB.
bool looks_like_gltf(std::string_view bytes);
/// True if the first token that is no comment is one of the words an OFF file begins with.
bool has_off_header(std::string_view bytes);

/// Elements between two calls of `Context::checkpoint`.
inline constexpr std::size_t checkpoint_interval = 1 << 16;

}  // namespace tri::io_detail
