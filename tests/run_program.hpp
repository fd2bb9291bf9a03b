#pragma once

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

}  // namespace tri::test
