#pragma once

#include <fast_float/fast_float.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "meshops/error.hpp"

namespace tri::io_detail {

/// 1-based number of the line that holds `where`; "\n", "\r\n" and a lone "\r" end a line.
inline std::uint64_t line_of(std::string_view text, const char* where) {
  std::uint64_t line = 1;
  for (const char* p = text.data(); p < where; ++p)
    if (*p == '\n' || (*p == '\r' && !(p + 1 < text.data() + text.size() && p[1] == '\n'))) ++line;
  return line;
}

/// What an error message shows of a piece of the file: printable and short.
inline std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, 40)) out += (static_cast<unsigned char>(c) < 32 || c == 127) ? '?' : c;
  return out + (text.size() > 40 ? "…\"" : "\"");
}

/// One number that fills `token` wholly; a leading "+" is allowed, as are "nan" and "inf". False if it is not a number.
inline bool parse_number(std::string_view token, double& value) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+') token.remove_prefix(1);
  const auto result = fast_float::from_chars(token.data(), token.data() + token.size(), value);
  return result.ec == std::errc() && result.ptr == token.data() + token.size();
}

/// Walks through a text by lines and blank-separated tokens. Line numbers are counted only when an error needs one.
class TextScanner {
 public:
  TextScanner(std::string_view text, const std::string& file) : TextScanner(text, file, text) {}
  /// @param numbering the same text with its original line ends, by which lines are numbered
  TextScanner(std::string_view text, const std::string& file, std::string_view numbering)
      : text_(text), numbering_(numbering), file_(file), p_(text.data()), end_(p_ + text.size()) {}

  bool at_end() const { return p_ >= end_; }
  const char* position() const { return p_; }
  std::size_t offset() const { return static_cast<std::size_t>(p_ - text_.data()); }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - p_); }
  void move_to(const char* where) { p_ = where; }

  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool line_end(char c) { return c == '\n' || c == '\r'; }

  void skip_blanks() {
    while (p_ < end_ && blank(*p_)) ++p_;
  }
  /// True at the end of a line or of the text, after blanks.
  bool at_line_end() {
    skip_blanks();
    return p_ >= end_ || line_end(*p_);
  }
  /// As `at_line_end`, where a comment that begins with `comment` counts as the end.
  bool at_line_end(char comment) { return at_line_end() || *p_ == comment; }
  /// The rest of the line without its end; then stands on the end.
  std::string_view rest_of_line() {
    const char* first = p_;
    while (p_ < end_ && !line_end(*p_)) ++p_;
    return {first, static_cast<std::size_t>(p_ - first)};
  }
  /// To the start of the next line, whatever is left on this one.
  void next_line() {
    while (p_ < end_ && !line_end(*p_)) ++p_;
    if (p_ < end_ && *p_ == '\r') ++p_;  // "\r\n" is one end of a line, as is a lone "\r"
    if (p_ < end_ && *p_ == '\n') ++p_;
  }
  /// To the first token of the next line that has one and does not begin with `comment` (0: none). False at the end.
  bool next_filled_line(char comment) {
    while (p_ < end_) {
      skip_blanks();
      if (p_ < end_ && !line_end(*p_) && !(comment && *p_ == comment)) return true;
      next_line();
    }
    return false;
  }
  /// The next token of this line; empty at its end.
  std::string_view token() {
    skip_blanks();
    const char* first = p_;
    while (p_ < end_ && !blank(*p_) && !line_end(*p_)) ++p_;
    return {first, static_cast<std::size_t>(p_ - first)};
  }
  /// The next token, over line ends; empty only at the end of the text.
  std::string_view token_across_lines() {
    while (p_ < end_ && (blank(*p_) || line_end(*p_))) ++p_;
    return token();
  }

  /// A number on this line. @throws IoError if there is none.
  double number(const char* what) {
    skip_blanks();
    const char* first = p_;
    if (p_ < end_ && *p_ == '+') ++p_;
    double value = 0;
    const auto result = fast_float::from_chars(p_, end_, value);
    if (result.ec != std::errc() || (result.ptr < end_ && !blank(*result.ptr) && !line_end(*result.ptr))) {
      p_ = first;
      fail_token(what, "a number");
    }
    p_ = result.ptr;
    return value;
  }
  /// A coordinate: a number that is finite.
  double coordinate(const char* what) {
    skip_blanks();
    const char* first = p_;
    const double value = number(what);
    if (!std::isfinite(value)) {
      p_ = first;
      fail(std::string(what) + " " + quoted(token()) + " is not finite", first);
    }
    return value;
  }
  /// A decimal integer on this line; a value like "3.0" is not one.
  std::int64_t integer(const char* what) {
    skip_blanks();
    const char* first = p_;
    if (p_ < end_ && *p_ == '+') ++p_;
    std::int64_t value = 0;
    const auto result = std::from_chars(p_, end_, value);
    if (result.ec != std::errc() || (result.ptr < end_ && !blank(*result.ptr) && !line_end(*result.ptr))) {
      p_ = first;
      fail_token(what, "an integer");
    }
    p_ = result.ptr;
    return value;
  }

  [[noreturn]] void fail(const std::string& message, const char* where) const {
    throw IoError(file_, message, IoError::Unit::line, line_of(numbering_, numbering_.data() + (where - text_.data())));
  }
  [[noreturn]] void fail(const std::string& message) const { fail(message, p_); }

 private:
  [[noreturn]] void fail_token(const char* what, const char* wanted) {
    const char* first = p_;
    const std::string_view found = token();
    if (found.empty() && p_ >= end_) fail(std::string("the file ends where ") + what + " should be", first);
    if (found.empty()) fail(std::string("the line ends where ") + what + " should be", first);
    fail(std::string(what) + ": " + quoted(found) + " is not " + wanted, first);
  }

  std::string_view text_;
  std::string_view numbering_;
  const std::string& file_;
  const char* p_;
  const char* end_;
};

}  // namespace tri::io_detail
