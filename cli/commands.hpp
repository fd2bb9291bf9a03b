#pragma once

#include "cli/program.hpp"

namespace tri::cli {

/// Each adds one command to the application: its options, its help with an example, and what it does in
/// `program.action`.
void add_align_command(CLI::App& app, Program& program);
void add_check_command(CLI::App& app, Program& program);
void add_compare_command(CLI::App& app, Program& program);
void add_info_command(CLI::App& app, Program& program);
void add_model_command(CLI::App& app, Program& program);
void add_ops_command(CLI::App& app, Program& program);
void add_register_command(CLI::App& app, Program& program);
void add_render_command(CLI::App& app, Program& program);
void add_repair_command(CLI::App& app, Program& program);
void add_run_command(CLI::App& app, Program& program);
void add_sample_command(CLI::App& app, Program& program);
void add_triangulate_command(CLI::App& app, Program& program);

}  // namespace tri::cli
