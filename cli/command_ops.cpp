#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "cli/commands.hpp"
#include "cli/plugins_input.hpp"
#include "meshops/registry.hpp"

namespace tri::cli {
namespace {

std::string default_text(const OptionSchema::Entry& entry, const void* defaults) {
  struct {
    std::string operator()(bool v) const { return v ? "on" : "off"; }
    std::string operator()(std::int64_t v) const { return fmt::format("{}", v); }
    std::string operator()(double v) const { return fmt::format("{:.6g}", v); }
    std::string operator()(const std::string& v) const { return v.empty() ? "none" : v; }
    std::string operator()(const std::vector<double>& v) const {
      return v.empty() ? "none" : fmt::format("{}", fmt::join(v, ","));
    }
  } visitor;
  return std::visit(visitor, entry.get(defaults));
}

std::string option_text(const OptionSchema::Entry& entry, const void* defaults) {
  const OptionInfo& info = entry.info;
  const bool is_flag = info.type == OptionInfo::Type::boolean;
  const std::string left = is_flag ? fmt::format("--[no-]{}", info.name) : fmt::format("--{} VALUE", info.name);
  return fmt::format("  {:<26} {}\n  {:<26}   default {}{}\n", left, info.help, "", default_text(entry, defaults),
                     is_flag ? "" : fmt::format("; {}", info.allowed()));
}

std::string one_operator(const Operator& op) {
  std::string text = fmt::format("{}  (works on: {})\n{}\n", op.name(), to_string(op.domain()), op.summary());
  const auto defaults = op.schema().make();
  for (const auto& entry : op.schema().entries()) text += option_text(entry, defaults.get());
  return text;
}

int run(const Registry& registry, const std::string& name, bool json) {
  if (json) {
    const Json all = registry.describe();
    if (name.empty()) {
      print_result(all);
    } else {
      for (const Json& op : all)
        if (op["name"] == name) print_result(op);
    }
    return exit_done;
  }
  std::string text;
  if (name.empty()) {
    for (const auto& op : registry.operators())
      text += fmt::format("{:<22} {:<7} {}\n", op->name(), to_string(op->domain()), op->summary());
    text += "\n`tri ops NAME` explains the options of one.\n";
  } else {
    text = one_operator(registry.at(name));
  }
  print_result(text);
  return exit_done;
}

}  // namespace

void add_ops_command(CLI::App& app, Program& program) {
  auto* command = app.add_subcommand("ops", "List the operators of `tri run`, or explain one");
  struct OpsArguments {
    std::string name;
    std::vector<std::string> plugins;
    bool json = false;
  };
  const auto a = std::make_shared<OpsArguments>();
  command->add_option("name", a->name, "Operator to explain; without, all are listed");
  command->add_flag("--json", a->json, "Names, options, units, ranges and defaults as JSON");
  add_plugins_option(*command, a->plugins);
  command->footer(
      "Examples:\n"
      "  tri ops\n"
      "  tri ops fill-holes\n"
      "  tri ops --json");
  command->callback([a, &program] {
    const auto registry = std::make_shared<const Registry>(registry_with_plugins(a->plugins));
    if (!a->name.empty()) usage([&] { return &registry->at(a->name); });
    program.action = [a, registry] { return run(*registry, a->name, a->json); };
  });
}

}  // namespace tri::cli
