#pragma once

#include <tbb/parallel_sort.h>

#include <functional>

#include "meshops/context.hpp"
#include "meshops/error.hpp"

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

}  // namespace tri
