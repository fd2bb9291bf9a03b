#pragma once

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tri::test {

struct Outcome {
  int exit_code = -1;  ///< 128 + signal if the program was ended by one
  std::string out, err;
};

/// Runs the built program `tri` with these arguments in `folder` and waits for it.
/// @param out_path where standard output goes, say "/dev/full"; empty collects it in the result
/// @param interrupt_after_ms if positive, sends SIGINT after so many milliseconds
Outcome run_tri(const std::vector<std::string>& arguments, const std::string& folder, const std::string& out_path = "",
                int interrupt_after_ms = 0);

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The JSON that the program printed; it has to have ended well.
inline nlohmann::json parsed(const Outcome& outcome) {
  CAPTURE(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  return nlohmann::json::parse(outcome.out);
}

}  // namespace tri::test
