#pragma once

#include "io/mesh_file.hpp"

namespace tri::io_detail {

/// For a format that holds floats only: counts in the report what rounding to them changes, and says it in notes.
/// @param format "binary STL" @throws InvalidInput naming the first vertex that is beyond the floats
void note_rounding_to_floats(const Soup& soup, const char* format, MeshWriteReport& report);

}  // namespace tri::io_detail
