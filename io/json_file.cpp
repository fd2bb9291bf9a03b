#include "io/json_file.hpp"

#include "io/atomic_file.hpp"
#include "io/input_file.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

template <class Json>
std::string indented(const Json& value) {
  // File names from a command line need not be UTF-8; they must not keep a report from being written.
  return value.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

nlohmann::json read_json(const std::string& path) {
  const InputFile file(path);
  try {
    return nlohmann::json::parse(file.bytes());
  } catch (const nlohmann::json::parse_error& error) {
    throw IoError(file.name(), std::string("is not valid JSON: ") + error.what(), IoError::Unit::byte,
                  error.byte > 0 ? error.byte - 1 : 0);
  }
}

void write_json(const std::string& path, const nlohmann::json& value) {
  write_file(path, indented(value));
}
void write_json(const std::string& path, const nlohmann::ordered_json& value) {
  write_file(path, indented(value));
}

}  // namespace tri
