#include "cli/program.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "cli/progress.hpp"
#include "io/atomic_file.hpp"
#include "io/input_file.hpp"

namespace tri::cli {

void add_common_options(CLI::App& command, Program& program) {
  command.add_flag("-q,--quiet", program.quiet, "No progress and no notes on standard error");
  command
      .add_option("--threads", program.context.threads,
                  "Threads to use at most; 0 takes every core. Results do not change")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
}

void print_note(const std::string& line) {
  clear_progress();
  fmt::print(stderr, "tri: {}\n", line);
}

void print_result(const std::string& text) {
  clear_progress();
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw IoError("standard output", std::strerror(errno));
}

void print_result(const nlohmann::ordered_json& value) {
  print_result(value.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void check_output(const std::string& path) {
  std::error_code none;
  // Opening a pipe would wait for its reader, and opening a device may do something.
  const auto status = std::filesystem::status(path, none);
  if (path == "-" || (std::filesystem::exists(status) && std::filesystem::is_other(status))) return;
  const AtomicFile probe(path);
}

void require_extension(const std::string& path, const std::vector<std::string>& extensions, const std::string& what) {
  const std::string extension = file_extension(path);
  std::string list;
  for (const std::string& allowed : extensions) {
    if (extension == allowed) return;
    list += (list.empty() ? "." : ", .") + allowed;
  }
  throw UsageError(fmt::format("{} \"{}\" must end in {}", what, path, list));
}

std::string kind_of(const std::string& path) {
  const std::string extension = file_extension(path);
  const auto is_one_of = [&](std::initializer_list<const char*> list) {
    return std::find(list.begin(), list.end(), extension) != list.end();
  };
  if (is_one_of({"igs", "iges", "stp", "step", "brep"})) return "cad";
  if (is_one_of({"stl", "obj", "off", "ply", "3mf", "gltf", "glb", "vtp"})) return "mesh";
  if (is_one_of({"xyz", "asc", "csv", "txt", "pts", "pcd", "ptx", "e57"})) return "points";
  return "";
}

std::string with_commas(std::uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

}  // namespace tri::cli
