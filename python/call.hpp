#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <optional>
#include <type_traits>
#include <utility>

#include "meshops/context.hpp"
#include "meshops/error.hpp"

namespace tri::python {

namespace py = pybind11;

/// Runs `work(context)` without Python's lock. `progress(step, share)` is called at most 50 times a second and at the
/// end of each step; what it raises, and Ctrl-C in the main thread, cancels the work and is raised when the work has
/// stopped.
class Call {
 public:
  /// @param progress  callable or None @param threads  as `Context::threads`; InvalidInput if negative
  Call(py::object progress, int threads);

  template <class Work>
  auto run(const Work& work) {
    std::exception_ptr failure;
    struct Nothing {};
    constexpr bool is_void = std::is_void_v<decltype(work(context_))>;
    std::conditional_t<is_void, Nothing, std::optional<std::conditional_t<is_void, Nothing, decltype(work(context_))>>>
        result;
    {
      const py::gil_scoped_release unlocked;
      try {
        if constexpr (is_void)
          work(context_);
        else
          result.emplace(work(context_));
      } catch (...) {
        failure = std::current_exception();
      }
    }
    if (raised_) std::rethrow_exception(raised_);
    if (failure) std::rethrow_exception(failure);
    if constexpr (!is_void) return std::move(*result);
  }

 private:
  void raise();

  Context context_;
  py::object progress_;
  std::exception_ptr raised_;  // by Python, while the work ran
};

}  // namespace tri::python
