#pragma once

#include <string_view>

namespace tri::html {

/// The files of io/html and three.js (empty if it was not found when the program was configured), compiled in.
extern const std::string_view page;
extern const std::string_view style;
extern const std::string_view script;
extern const std::string_view three;

}  // namespace tri::html
