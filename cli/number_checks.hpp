#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace tri::cli {

/// Accepts numbers above 0. CLI11's own check names the largest double as the upper end in its message.
inline CLI::Validator above_zero() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value > 0 && std::isfinite(value)) return std::string();
        return text + " is not a number above 0";
      },
      "ABOVE 0");
}

/// Accepts 0 and numbers above it.
inline CLI::Validator not_negative() {
  return CLI::Validator(
      [](std::string& text) {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= 0 && std::isfinite(value)) return std::string();
        return text + " is not a number from 0 upward";
      },
      "FROM 0");
}

}  // namespace tri::cli
