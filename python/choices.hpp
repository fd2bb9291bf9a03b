#pragma once

#include <initializer_list>
#include <string>
#include <utility>

#include "meshops/error.hpp"

namespace tri::python {

/// The value that an option's text stands for. @throws InvalidInput naming the option, the text and what is allowed
template <class Value>
Value choice(const char* option, const std::string& text,
             std::initializer_list<std::pair<const char*, Value>> allowed) {
  std::string names;
  for (const auto& [name, value] : allowed) {
    if (text == name) return value;
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  throw InvalidInput(std::string(option) + " = " + text + " is not allowed; allowed: " + names);
}

}  // namespace tri::python
