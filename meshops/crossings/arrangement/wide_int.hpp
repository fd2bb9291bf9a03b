#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tri {

__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

/// A signed integer of 64 N bits in two's complement, for signs and fractions whose size is known beforehand. Results
/// that do not fit wrap around: the caller chooses N.
template <int N>
class WideInt {
 public:
  WideInt() : limbs_{} {}
  WideInt(std::int64_t value) {
    limbs_.fill(value < 0 ? ~std::uint64_t{0} : 0);
    limbs_[0] = static_cast<std::uint64_t>(value);
  }
  static WideInt from_int128(Int128 value) requires(N >= 2) {
    WideInt r(value < 0 ? -1 : 0);
    r.limbs_[0] = static_cast<std::uint64_t>(value);
    r.limbs_[1] = static_cast<std::uint64_t>(value >> 64);
    return r;
  }
  /// @tparam M at most N: the sign is extended.
  template <int M>
  explicit WideInt(const WideInt<M>& narrow) {
    static_assert(M <= N);
    limbs_.fill(narrow.negative() ? ~std::uint64_t{0} : 0);
    for (int i = 0; i < M; ++i) limbs_[i] = narrow.limb(i);
  }

  static WideInt from_limbs(const std::array<std::uint64_t, N>& limbs) {
    WideInt r;
    r.limbs_ = limbs;
    return r;
  }

  bool negative() const { return static_cast<std::int64_t>(limbs_[N - 1]) < 0; }
  std::uint64_t limb(int i) const { return limbs_[i]; }
  int sign() const {
    if (negative()) return -1;
    for (const std::uint64_t limb : limbs_)
      if (limb != 0) return 1;
    return 0;
  }

  friend WideInt operator+(const WideInt& a, const WideInt& b) {
    WideInt r;
    UInt128 carry = 0;
    for (int i = 0; i < N; ++i) {
      carry += static_cast<UInt128>(a.limbs_[i]) + b.limbs_[i];
      r.limbs_[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    return r;
  }
  WideInt operator-() const {
    WideInt r;
    for (int i = 0; i < N; ++i) r.limbs_[i] = ~limbs_[i];
    return r + WideInt(1);
  }
  friend WideInt operator-(const WideInt& a, const WideInt& b) { return a + -b; }
  friend bool operator==(const WideInt&, const WideInt&) = default;
  /// Times 2^bits, 0 <= bits < 64.
  WideInt shifted(int bits) const {
    if (bits == 0) return *this;
    WideInt r;
    for (int i = N - 1; i >= 0; --i) r.limbs_[i] = limbs_[i] << bits | (i > 0 ? limbs_[i - 1] >> (64 - bits) : 0);
    return r;
  }

  /// Within a few units in the last place.
  double to_double() const {
    const bool minus = negative();
    const WideInt m = minus ? -*this : *this;
    int top = N - 1;
    while (top > 0 && m.limbs_[top] == 0) --top;
    double value = static_cast<double>(m.limbs_[top]);
    if (top > 0) value = value * 0x1p64 + static_cast<double>(m.limbs_[top - 1]);
    if (top > 1) value = std::ldexp(value, 64 * (top - 1));
    return minus ? -value : value;
  }

 private:
  std::array<std::uint64_t, N> limbs_;
};

/// The product in R limbs.
template <int R, int A, int B>
WideInt<R> product(const WideInt<A>& a, const WideInt<B>& b) {
  const bool minus = a.negative() != b.negative();
  const WideInt<A> x = a.negative() ? -a : a;
  const WideInt<B> y = b.negative() ? -b : b;
  std::array<std::uint64_t, R> limbs{};
  for (int i = 0; i < A && i < R; ++i) {
    if (x.limb(i) == 0) continue;
    UInt128 carry = 0;
    for (int j = 0; i + j < R && (j < B || carry != 0); ++j) {
      // 2^64 - 1 squared plus twice as much again still fits.
      if (j < B) carry += static_cast<UInt128>(x.limb(i)) * y.limb(j);
      carry += limbs[i + j];
      limbs[i + j] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
  }
  const WideInt<R> r = WideInt<R>::from_limbs(limbs);
  return minus ? -r : r;
}

}  // namespace tri
