#include <fmt/format.h>

#include <CLI/CLI.hpp>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <new>

#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress.hpp"
#include "meshops/version.hpp"

namespace {

using namespace tri;
using namespace tri::cli;

// Takes the steps of a pipeline out of the words, so that only the rest is for the option parser: "tri run IN ! op --x
// 1 ! OUT --save r.json" has the step {op, --x, 1} and the rest {run, IN, OUT, --save, r.json}.
std::vector<std::string> without_steps(std::vector<std::string> words, Program& program) {
  const auto first = std::find(words.begin(), words.end(), "!");
  if (first == words.end()) return words;
  program.has_steps = true;
  const auto last = std::find(words.rbegin(), words.rend(), "!").base() - 1;
  if (first != last) {
    program.steps.assign(first + 1, last);
    if (program.steps.empty()) throw UsageError("a step between two \"!\" is empty");
  }
  words.erase(first, last + 1);
  return words;
}

int parse_and_run(CLI::App& app, Program& program, std::vector<std::string> words) {
  words = without_steps(std::move(words), program);
  const bool is_run = !words.empty() && words.front() == "run";
  if (program.has_steps && !is_run) throw UsageError("\"!\" belongs to `tri run`");
  const auto named = [&](const CLI::App* command) { return !words.empty() && command->get_name() == words.front(); };
  if (!words.empty() && !words.front().starts_with('-') && app.get_subcommands(named).empty())
    throw UsageError("there is no command \"" + words.front() + "\" (tri --help)");
  std::reverse(words.begin(), words.end());
  app.parse(std::move(words));
  show_progress(program.context, program.quiet);
  cancel_on_interrupt(program.context);
  const int code = program.action();
  clear_progress();
  return code;
}

// The command whose --help answers questions about the command line.
std::string help_of(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? "tri --help" : "tri " + chosen.front()->get_name() + " --help";
}

int fail(ExitCode code, const std::string& message) {
  print_note(message);
  return code;
}

int run_program(CLI::App& app, Program& program, const std::vector<std::string>& words) {
  try {
    if (words.empty()) {
      fmt::print(stderr, "{}", app.help());
      return exit_usage;
    }
    try {
      return parse_and_run(app, program, words);
    } catch (const CLI::CallForHelp&) {
      const auto chosen = app.get_subcommands();
      print_result(chosen.empty() ? app.help() : chosen.front()->help("tri"));
      return exit_done;
    } catch (const CLI::CallForVersion&) {
      print_result(std::string("tri ") + version + "\n");
      return exit_done;
    } catch (const CLI::ParseError& e) {
      throw UsageError(std::string(e.what()) + " (" + help_of(app) + ")");
    }
  } catch (const UsageError& e) {
    return fail(exit_usage, e.what());
  } catch (const IoError& e) {
    return fail(exit_file, e.what());
  } catch (const CadError& e) {
    return fail(exit_file, e.what());
  } catch (const Cancelled&) {
    return fail(exit_interrupted, "interrupted; nothing was written");
  } catch (const std::bad_alloc&) {
    return fail(exit_failed, "out of memory");
  } catch (const std::exception& e) {
    return fail(exit_failed, e.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
#if defined(M_TRIM_THRESHOLD)
  // By default glibc keeps freed arrays of up to 32 MB for itself: with a million points a quarter of all memory.
  mallopt(M_TRIM_THRESHOLD, 1 << 20);
#endif
  CLI::App app{"tri: triangle meshes from CAD models, measured points and broken files", "tri"};
  app.set_version_flag("--version", version, "Print the version");
  app.set_help_flag("-h,--help", "Print this help; `tri COMMAND --help` explains a command");
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  app.footer(
      "Exit codes: 0 done, 1 the operation failed, 2 wrong usage, 3 a file that cannot be read or written or holds\n"
      "nothing usable, 130 interrupted. Results go to standard output, progress and notes to standard error. An output\n"
      "file appears whole or not at all.\n\n"
      "Example:\n"
      "  tri model boot-lid -o lid.igs\n"
      "  tri sample --cad lid.igs -n 3400 --noise 0.02 -o lid.xyz\n"
      "  tri triangulate --cad lid.igs lid.xyz -o lid.ply\n"
      "  tri render lid.ply -o lid.png --edges");
  Program program;
#ifdef TRI_WITH_CAD
  add_triangulate_command(app, program);
  add_align_command(app, program);
  add_register_command(app, program);
  add_sample_command(app, program);
  add_model_command(app, program);
#endif
  add_compare_command(app, program);
  add_info_command(app, program);
  add_check_command(app, program);
  add_repair_command(app, program);
  add_run_command(app, program);
  add_ops_command(app, program);
  add_render_command(app, program);
  return run_program(app, program, {argv + 1, argv + argc});
}
