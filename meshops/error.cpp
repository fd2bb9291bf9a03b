#include "meshops/error.hpp"

namespace tri {
namespace {

std::string located(const std::string& file, const std::string& message, IoError::Unit unit, std::uint64_t position) {
  switch (unit) {
    case IoError::Unit::line:
      return file + ":" + std::to_string(position) + ": " + message;
    case IoError::Unit::byte:
      return file + ": byte " + std::to_string(position) + ": " + message;
    case IoError::Unit::none:
      break;
  }
  return file + ": " + message;
}

}  // namespace

IoError::IoError(std::string file, const std::string& message, Unit unit, std::uint64_t position)
    : Error(located(file, message, unit, position)), file_(std::move(file)), unit_(unit), position_(position) {}

}  // namespace tri
