#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace tri {

/// Base of every exception the library throws on purpose.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A broken contract: an option out of range, an unknown name, a mesh in the wrong state.
class InvalidInput : public Error {
 public:
  using Error::Error;
};

/// A file that cannot be read or written, or holds what no reader accepts.
class IoError : public Error {
 public:
  /// What a position counts.
  enum class Unit { none, line, byte };

  /// The message becomes "FILE: MESSAGE", "FILE:LINE: MESSAGE" or "FILE: byte N: MESSAGE".
  IoError(std::string file, const std::string& message, Unit unit = Unit::none, std::uint64_t position = 0);

  /// As it was given to the reader or writer.
  const std::string& file() const noexcept { return file_; }
  /// What `position()` counts; `none` if the error is of the file as a whole.
  Unit unit() const noexcept { return unit_; }
  /// 1-based line or 0-based byte offset, as `unit()` says; 0 without a position.
  std::uint64_t position() const noexcept { return position_; }

 private:
  std::string file_;
  Unit unit_;
  std::uint64_t position_;
};

/// A CAD model that can be read but not used: no face, or geometry no algorithm accepts.
class CadError : public Error {
 public:
  using Error::Error;
};

/// Work stopped because `Context::cancel` was set. The header of each operation says what state is left.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

}  // namespace tri
