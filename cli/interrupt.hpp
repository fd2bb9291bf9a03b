#pragma once

#include "meshops/context.hpp"

namespace tri::cli {

/// From here on an interrupt (Ctrl-C) or a request to end cancels `context`, which then leaves no partial output. A second
/// one ends the program at once, for the sake of libraries that cannot be stopped. `context` must live until the end.
void cancel_on_interrupt(Context& context);

}  // namespace tri::cli
