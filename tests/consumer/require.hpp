#pragma once

#include <cstdlib>
#include <iostream>

/// Ends the program with a message if a condition does not hold.
#define REQUIRE(condition)                                                                  \
  do {                                                                                      \
    if (!(condition)) {                                                                     \
      std::cerr << __FILE__ << ":" << __LINE__ << ": " << #condition << " does not hold\n"; \
      std::exit(1);                                                                         \
    }                                                                                       \
  } while (false)
