#include "cli/report_text.hpp"

#include <fmt/format.h>

#include "cli/program.hpp"

namespace tri::cli {

std::string to_text(const Report& r) {
  std::string changes;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) changes += fmt::format("{}{} {}", changes.empty() ? "" : ", ", with_commas(count), what);
  };
  add(r.vertices_added, "vertices added");
  add(r.vertices_removed, "vertices removed");
  add(r.vertices_moved, "vertices moved");
  add(r.faces_added, "faces added");
  add(r.faces_removed, "faces removed");
  add(r.faces_reversed, "faces reversed");
  add(r.edges_flipped, "edges flipped");
  std::string text =
      fmt::format("{:<20} {} ({:.3f} s)\n", r.operation, changes.empty() ? "nothing changed" : changes, r.seconds);
  for (const auto& [name, value] : r.figures) text += fmt::format("  {}: {:.6g}\n", name, value);
  for (const auto& [reason, count] : r.skipped)
    text += fmt::format("  left alone, {}: {}\n", reason, with_commas(count));
  for (const std::string& note : r.notes) text += fmt::format("  {}\n", note);
  return text;
}

}  // namespace tri::cli
