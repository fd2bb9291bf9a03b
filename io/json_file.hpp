#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tri {

/// Reads a JSON file ("-" is standard input).
/// @throws IoError with the byte offset if it is not JSON, or if the file cannot be read.
nlohmann::json read_json(const std::string& path);

/// Writes JSON with two blanks of indentation and a final line break; the file appears whole or not at all. Numbers
/// that are not finite become null. @throws IoError
void write_json(const std::string& path, const nlohmann::json& value);
/// The same with the keys in the order in which they were written.
void write_json(const std::string& path, const nlohmann::ordered_json& value);

}  // namespace tri
