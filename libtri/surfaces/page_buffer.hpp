#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace tri {

/// Uninitialised memory for plain data that lives through one algorithm. Large buffers ask for huge pages, because a
/// fresh page of 4 KiB costs a fault that takes as long as the work done on it.
template <class T>
class PageBuffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  PageBuffer() = default;
  /// @throws std::bad_alloc
  explicit PageBuffer(std::size_t count) {
    constexpr std::size_t huge_page = std::size_t{1} << 21;
    const std::size_t bytes = count * sizeof(T);
    const std::size_t alignment = bytes >= 2 * huge_page ? huge_page : 64;
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    alignment_ = std::align_val_t{alignment};
    data_ = static_cast<T*>(::operator new(rounded, alignment_));
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (alignment == huge_page) madvise(data_, rounded, MADV_HUGEPAGE);  // a hint: refusal changes nothing but the time
#endif
  }
  PageBuffer(PageBuffer&& other) noexcept : data_(std::exchange(other.data_, nullptr)), alignment_(other.alignment_) {}
  PageBuffer& operator=(PageBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(alignment_, other.alignment_);
    return *this;
  }
  ~PageBuffer() {
    reset();
  }

  void reset() {
    if (data_ != nullptr) ::operator delete(data_, alignment_);
    data_ = nullptr;
  }
  T* get() const {
    return data_;
  }
  T& operator[](std::size_t i) const {
    return data_[i];
  }

 private:
  T* data_ = nullptr;
  std::align_val_t alignment_{64};
};

}  // namespace tri
