#include <doctest/doctest.h>

#include <map>

#include "meshops/search/number_map.hpp"

using namespace tri;

TEST_CASE("NumberMap: numbers what std::map numbers, with many keys and few places expected") {
  for (const std::size_t expected : {std::size_t{0}, std::size_t{5000}}) {
    NumberMap<std::uint32_t> numbers(expected);
    std::map<std::uint32_t, std::uint32_t> truth;
    std::uint32_t key = 1;
    for (std::uint32_t i = 0; i < 5000; ++i) {
      key = key * 1664525u + 1013904223u;
      const std::uint32_t wanted = key % 3000;
      const auto [it, fresh] = truth.emplace(wanted, i);
      CHECK(numbers.insert(wanted, i) == std::pair{it->second, fresh});
    }
    CHECK(numbers.size() == truth.size());
    for (std::uint32_t k = 0; k < 3100; ++k) {
      const auto it = truth.find(k);
      CHECK(numbers.find(k) == (it == truth.end() ? no_index : it->second));
    }
  }
}
