#pragma once

#include "meshops/context.hpp"

namespace tri::cli {

/// Shows the steps of `context` as one line that renews itself on standard error, if that is a terminal; the log goes
/// to standard error line by line. Nothing of both with `quiet`.
void show_progress(Context& context, bool quiet);

/// Wipes the progress line, if one is shown, so that other text can follow.
void clear_progress();

}  // namespace tri::cli
