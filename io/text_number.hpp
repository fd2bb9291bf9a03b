#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "io/atomic_file.hpp"

namespace tri::io_detail {

/// Numbers and words into an output file, without a locale: doubles as the shortest decimal that reads back the same.
class TextWriter {
 public:
  explicit TextWriter(AtomicFile& file) : file_(file) {}

  TextWriter& operator<<(std::string_view text) {
    file_.write(text);
    return *this;
  }
  TextWriter& operator<<(char c) {
    file_.write({&c, 1});
    return *this;
  }
  template <class Number>
  requires std::is_arithmetic_v<Number> TextWriter& operator<<(Number value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, value).ptr;
    file_.write({text, static_cast<std::size_t>(end - text)});
    return *this;
  }

 private:
  AtomicFile& file_;
};

}  // namespace tri::io_detail
