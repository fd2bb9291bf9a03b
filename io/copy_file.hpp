#pragma once

#include <string>

namespace tri {

/// Writes the bytes of one file to another, which appears whole or not at all. Both may be the same file.
/// @throws IoError if one cannot be read or the other not be written.
void copy_file(const std::string& from, const std::string& to);

}  // namespace tri
