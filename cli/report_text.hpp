#pragma once

#include <string>

#include "meshops/report.hpp"

namespace tri::cli {

/// What an operator changed, left alone and found, for a person: one line, and one for each figure, reason and note.
std::string to_text(const Report& report);

}  // namespace tri::cli
