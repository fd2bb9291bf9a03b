#pragma once

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>
#include <functional>

#include "meshops/context.hpp"
#include "meshops/error.hpp"
#include "meshops/pace.hpp"

namespace tri {

/// Sorts on all threads; no two elements may be equal, so that the order does not depend on them.
/// @param context  null: cannot be cancelled
/// @throws Cancelled at once when that is asked for; the elements are then in no order
template <class Iterator, class Less = std::less<>>
void cancellable_sort(Iterator begin, Iterator end, const Context* context, const Less& less = {}) {
  tbb::parallel_sort(begin, end, [&](const auto& a, const auto& b) {
    if (context && context->cancelled()) throw Cancelled();
    return less(a, b);
  });
}

/// std::nth_element, which reaches checkpoints where there is much to do.
/// @throws Cancelled; the elements are then in some order
template <class Iterator, class Less>
void paced_nth_element(Iterator begin, Iterator nth, Iterator end, const Less& less, Pace& pace) {
  if (end - begin < std::ptrdiff_t{Pace::usual}) {
    std::nth_element(begin, nth, end, less);
    return;
  }
  std::nth_element(begin, nth, end, [&](const auto& a, const auto& b) {
    pace();
    return less(a, b);
  });
}

}  // namespace tri
