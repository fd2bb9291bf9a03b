#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/error.hpp"

namespace CLI {
class App;
}

namespace tri::cli {

/// A command line that cannot be carried out; exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// What `tri` returns to the shell.
enum ExitCode {
  exit_done = 0,    ///< also when the result is a small one: a region without measurements is a result
  exit_failed = 1,  ///< the operation could not be carried out
  exit_usage = 2,   ///< an option, an operator or a recipe is wrong
  exit_file = 3,    ///< a file cannot be read or written, or holds what no reader accepts
  exit_interrupted = 130
};

/// What the commands share while one of them runs.
struct Program {
  Context context;
  bool quiet = false;
  /// The command that was chosen; returns the exit code. Set while the command line is parsed, run afterwards.
  std::function<int()> action;
  /// Words between the first and the last "!" of the command line, further "!" included.
  std::vector<std::string> steps;
  /// True if the command line had a "!".
  bool has_steps = false;
};

/// Adds --quiet and --threads, which every command has that may take long.
void add_common_options(CLI::App& command, Program& program);

/// One line on standard error, "tri: LINE", after the progress line was cleared.
void print_note(const std::string& line);

/// Results for a person or, indented by two blanks, as JSON on standard output.
/// @throws IoError if it cannot be written (a full disk, a closed pipe).
void print_result(const std::string& text);
void print_result(const nlohmann::ordered_json& value);

/// Checks that a file can be made at `path`, before the long work begins; leaves nothing behind.
/// @throws IoError if its folder is missing or not writable, or it is a folder.
void check_output(const std::string& path);

/// @throws UsageError unless `path` ends in one of `extensions` (lower case, no dot); `what` names the file's role.
void require_extension(const std::string& path, const std::vector<std::string>& extensions, const std::string& what);

/// "mesh", "points" or "cad" by the ending of a file's name; empty if it does not tell.
std::string kind_of(const std::string& path);

/// The writable mesh formats.
inline const std::vector<std::string> mesh_extensions{"ply", "stl", "obj", "off", "3mf", "glb", "gltf", "vtp"};

/// Runs `check`, which looks at options only, and turns InvalidInput into UsageError.
template <class Check>
auto usage(const Check& check) {
  try {
    return check();
  } catch (const InvalidInput& e) {
    throw UsageError(e.what());
  }
}

/// "1234567" as "1,234,567".
std::string with_commas(std::uint64_t number);

}  // namespace tri::cli
