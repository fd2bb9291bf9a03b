#pragma once

#include "io/mesh_file.hpp"

namespace tri::io_detail {

/// Says in the report's notes which attributes of the soup its format has no place for. Each is named once.
void note_what_is_lost(const Soup& soup, bool ascii, MeshWriteReport& report);

/// Whether the corners have these values, all of them.
bool has_corner_scalars(const Soup& soup, std::initializer_list<const char*> names);

/// Texture coordinates that belong to vertices: of each vertex its own, if every vertex is in a triangle, all its
/// corners have the same ones ("s" and "t") and they are finite; else empty.
std::vector<std::array<double, 2>> vertex_textures(const Soup& soup);

}  // namespace tri::io_detail
