#pragma once

#include <cstddef>
#include <limits>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace tri {

/// Leaves the elements that a vector adds without a value uninitialised. Arrays begin at a cache line.
template <class T>
class PlainAllocator {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;  ///< as the standard library wants it
  /// Without state.
  PlainAllocator() = default;
  /// There is no state to take over.
  template <class U>
  PlainAllocator(const PlainAllocator<U>&) {}

  /// Memory for `count` values, at the start of a cache line. @throws std::bad_array_new_length, std::bad_alloc
  T* allocate(std::size_t count) {
    if (count > max_count) throw std::bad_array_new_length();
    return static_cast<T*>(::operator new(count * sizeof(T), line));
  }
  /// Gives back what `allocate` gave.
  void deallocate(T* data, std::size_t) { ::operator delete(data, line); }

  /// Leaves the value unset.
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  /// Makes the value of the arguments.
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

  /// One gives back the memory of any other.
  friend bool operator==(const PlainAllocator&, const PlainAllocator&) { return true; }

 private:
  static constexpr std::align_val_t line{64};
  static constexpr std::size_t max_count = std::numeric_limits<std::ptrdiff_t>::max() / sizeof(T);
};

/// An array of plain data that is filled after it was made, on several threads perhaps: zeros first would cost as much.
template <class T>
using PlainVector = std::vector<T, PlainAllocator<T>>;

}  // namespace tri
