#include "meshops/crossings/predicates.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace tri {
namespace {

__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

// A finite double as mantissa * 2^exponent with an odd mantissa (or zero).
struct Dyadic {
  std::int64_t mantissa = 0;
  int exponent = 0;
};

Dyadic dyadic(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int biased = static_cast<int>(bits >> 52 & 0x7ff);
  std::uint64_t mantissa = bits & ((std::uint64_t{1} << 52) - 1);
  if (biased != 0) mantissa |= std::uint64_t{1} << 52;
  if (mantissa == 0) return {};
  const int zeros = std::countr_zero(mantissa);
  mantissa >>= zeros;
  const auto magnitude = static_cast<std::int64_t>(mantissa);
  return {bits >> 63 ? -magnitude : magnitude, std::max(biased, 1) - 1075 + zeros};
}

int top_bit(const Dyadic& d) {  // exponent of the highest bit
  return d.exponent + 63 - std::countl_zero(static_cast<std::uint64_t>(std::abs(d.mantissa)));
}

// N coordinates over one power of two.
template <std::size_t N>
struct CommonScale {
  std::array<Dyadic, N> parts;
  int lowest = 0, highest = 0;

  explicit CommonScale(const std::array<double, N>& values) {
    bool first = true;
    for (std::size_t i = 0; i < N; ++i) {
      parts[i] = dyadic(values[i]);
      if (parts[i].mantissa == 0) continue;
      lowest = first ? parts[i].exponent : std::min(lowest, parts[i].exponent);
      highest = first ? top_bit(parts[i]) : std::max(highest, top_bit(parts[i]));
      first = false;
    }
  }
  bool fits(int bits) const { return highest - lowest < bits; }
  std::int64_t integer(std::size_t i) const {
    const auto& p = parts[i];
    return p.mantissa == 0 ? 0 : p.mantissa * (std::int64_t{1} << (p.exponent - lowest));
  }
};

int sign(Int128 value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

// Two's complement, least significant limb first.
class Int256 {
 public:
  void add_product(Int128 a, Int128 b) {
    const bool negative = (a < 0) != (b < 0);
    const UInt128 x = a < 0 ? -static_cast<UInt128>(a) : static_cast<UInt128>(a);
    const UInt128 y = b < 0 ? -static_cast<UInt128>(b) : static_cast<UInt128>(b);
    const UInt128 x0 = static_cast<std::uint64_t>(x), x1 = x >> 64, y0 = static_cast<std::uint64_t>(y), y1 = y >> 64;
    const UInt128 low = x0 * y0, cross_a = x0 * y1, cross_b = x1 * y0, high = x1 * y1;
    const UInt128 middle = (low >> 64) + static_cast<std::uint64_t>(cross_a) + static_cast<std::uint64_t>(cross_b);
    const UInt128 lower = (middle << 64) | static_cast<std::uint64_t>(low);
    const UInt128 upper = high + (cross_a >> 64) + (cross_b >> 64) + (middle >> 64);
    if (negative) {
      const UInt128 before = low_;
      low_ -= lower;
      high_ -= upper + (before < lower);
    } else {
      low_ += lower;
      high_ += upper + (low_ < lower);
    }
  }
  int sign() const {
    if (static_cast<Int128>(high_) < 0) return -1;
    return high_ != 0 || low_ != 0;
  }

 private:
  UInt128 low_ = 0, high_ = 0;
};

// A signed integer of any size, for coordinates whose bits lie too far apart for 256 bits. Rare, so plain.
class BigInt {
 public:
  BigInt() = default;
  explicit BigInt(const Dyadic& d, int lowest) : negative_(d.mantissa < 0) {
    if (d.mantissa == 0) return;
    const int shift = d.exponent - lowest;
    limbs_.assign(static_cast<std::size_t>(shift / 32), 0);
    const UInt128 m = static_cast<UInt128>(static_cast<std::uint64_t>(std::abs(d.mantissa))) << (shift % 32);
    for (int k = 0; k < 3; ++k) limbs_.push_back(static_cast<std::uint32_t>(m >> (32 * k)));
    trim();
  }
  friend BigInt operator+(const BigInt& a, const BigInt& b) {
    if (a.negative_ == b.negative_) return BigInt(add(a.limbs_, b.limbs_), a.negative_);
    if (compare(a.limbs_, b.limbs_) >= 0) return BigInt(subtract(a.limbs_, b.limbs_), a.negative_);
    return BigInt(subtract(b.limbs_, a.limbs_), b.negative_);
  }
  friend BigInt operator-(const BigInt& a, const BigInt& b) {
    BigInt minus = b;
    minus.negative_ = !b.negative_;
    return a + minus;
  }
  friend BigInt operator*(const BigInt& a, const BigInt& b) {
    Limbs product(a.limbs_.size() + b.limbs_.size(), 0);
    for (std::size_t i = 0; i < a.limbs_.size(); ++i) {
      std::uint64_t carry = 0;
      for (std::size_t j = 0; j < b.limbs_.size(); ++j) {
        carry += product[i + j] + std::uint64_t{a.limbs_[i]} * b.limbs_[j];
        product[i + j] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
      product[i + b.limbs_.size()] = static_cast<std::uint32_t>(carry);
    }
    return BigInt(std::move(product), a.negative_ != b.negative_);
  }
  int sign() const { return limbs_.empty() ? 0 : negative_ ? -1 : 1; }

 private:
  using Limbs = std::vector<std::uint32_t>;
  BigInt(Limbs limbs, bool negative) : limbs_(std::move(limbs)), negative_(negative) { trim(); }
  void trim() {
    while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
  }
  static int compare(const Limbs& a, const Limbs& b) {
    if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
    for (std::size_t i = a.size(); i-- > 0;)
      if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return 0;
  }
  static Limbs add(const Limbs& a, const Limbs& b) {
    Limbs sum(std::max(a.size(), b.size()) + 1, 0);
    std::uint64_t carry = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      carry += (i < a.size() ? std::uint64_t{a[i]} : 0) + (i < b.size() ? std::uint64_t{b[i]} : 0);
      sum[i] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
    return sum;
  }
  static Limbs subtract(const Limbs& a, const Limbs& b) {  // a >= b
    Limbs difference = a;
    std::int64_t borrow = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      std::int64_t value = std::int64_t{a[i]} - (i < b.size() ? std::int64_t{b[i]} : 0) - borrow;
      borrow = value < 0;
      if (borrow) value += std::int64_t{1} << 32;
      difference[i] = static_cast<std::uint32_t>(value);
    }
    return difference;
  }

  Limbs limbs_;
  bool negative_ = false;
};

}  // namespace

int orientation_exact(const Vec2& a, const Vec2& b, const Vec2& c) {
  const CommonScale<6> s({a[0], a[1], b[0], b[1], c[0], c[1]});
  if (s.fits(61)) {
    const Int128 ax = s.integer(0) - s.integer(4), ay = s.integer(1) - s.integer(5);
    const Int128 bx = s.integer(2) - s.integer(4), by = s.integer(3) - s.integer(5);
    return sign(ax * by - ay * bx);
  }
  const auto big = [&](int i) { return BigInt(s.parts[static_cast<std::size_t>(i)], s.lowest); };
  const BigInt cx = big(4), cy = big(5);
  return ((big(0) - cx) * (big(3) - cy) - (big(1) - cy) * (big(2) - cx)).sign();
}

int in_circle_exact(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const CommonScale<8> s({a[0], a[1], b[0], b[1], c[0], c[1], d[0], d[1]});
  if (s.fits(61)) {  // differences below 2^62, minors and squared lengths below 2^125
    const Int128 dx = s.integer(6), dy = s.integer(7);
    const Int128 ax = s.integer(0) - dx, ay = s.integer(1) - dy;
    const Int128 bx = s.integer(2) - dx, by = s.integer(3) - dy;
    const Int128 cx = s.integer(4) - dx, cy = s.integer(5) - dy;
    Int256 det;
    det.add_product(ax * ax + ay * ay, bx * cy - cx * by);
    det.add_product(bx * bx + by * by, cx * ay - ax * cy);
    det.add_product(cx * cx + cy * cy, ax * by - bx * ay);
    return det.sign();
  }
  const auto big = [&](int i) { return BigInt(s.parts[static_cast<std::size_t>(i)], s.lowest); };
  const BigInt dx = big(6), dy = big(7);
  const BigInt ax = big(0) - dx, ay = big(1) - dy, bx = big(2) - dx, by = big(3) - dy, cx = big(4) - dx,
               cy = big(5) - dy;
  return ((ax * ax + ay * ay) * (bx * cy - cx * by) + (bx * bx + by * by) * (cx * ay - ax * cy) +
          (cx * cx + cy * cy) * (ax * by - bx * ay))
      .sign();
}

int orientation_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  double largest[3];
  for (int k = 0; k < 3; ++k)
    largest[k] = std::max({std::abs(a[k] - d[k]), std::abs(b[k] - d[k]), std::abs(c[k] - d[k])});
  if (largest[0] == 0 || largest[1] == 0 || largest[2] == 0) return 0;  // in one plane across an axis
  const double size = largest[0] * largest[1] * largest[2];
  if (size > 1e-200 && size < 1e200) {  // far from underflow and overflow
    const Vec3 p = a - d, q = b - d, r = c - d;
    const double det = p | (q % r);
    // Shewchuk's bound for the permanent: 7 eps times six products, each below the product of the extents.
    const double bound = 6 * 8e-16 * size;
    if (det > bound) return 1;
    if (det < -bound) return -1;
  }
  const CommonScale<12> s({a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]});
  if (s.fits(61)) {  // differences below 2^62, minors below 2^125
    const auto part = [&](int point, int k) -> Int128 {
      return s.integer(static_cast<std::size_t>(3 * point + k)) - s.integer(static_cast<std::size_t>(9 + k));
    };
    const auto minor = [&](int p, int q, int k, int m) { return part(p, k) * part(q, m) - part(p, m) * part(q, k); };
    Int256 det;
    det.add_product(part(0, 0), minor(1, 2, 1, 2));
    det.add_product(part(0, 1), minor(1, 2, 2, 0));
    det.add_product(part(0, 2), minor(1, 2, 0, 1));
    return det.sign();
  }
  const auto part = [&](int point, int k) {
    return BigInt(s.parts[static_cast<std::size_t>(3 * point + k)], s.lowest) -
           BigInt(s.parts[static_cast<std::size_t>(9 + k)], s.lowest);
  };
  const auto minor = [&](int k, int m) { return part(1, k) * part(2, m) - part(1, m) * part(2, k); };
  return (part(0, 0) * minor(1, 2) + part(0, 1) * minor(2, 0) + part(0, 2) * minor(0, 1)).sign();
}

bool collinear_exact(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (int k = 0; k < 3; ++k) {
    const int m = k == 2 ? 0 : k + 1;
    // Far from the error of the three operations the sign of the minor is certain.
    const double left = (a[k] - c[k]) * (b[m] - c[m]), right = (a[m] - c[m]) * (b[k] - c[k]);
    const double size = std::abs(left) + std::abs(right);
    if (size > 1e-200 && size < 1e200 && std::abs(left - right) > 1e-15 * size) return false;
  }
  for (int k = 0; k < 3; ++k) {
    const int m = k == 2 ? 0 : k + 1;
    if (orientation_exact(Vec2(a[k], a[m]), Vec2(b[k], b[m]), Vec2(c[k], c[m])) != 0) return false;
  }
  return true;
}

BitRange bit_range(std::span<const Vec2> points) {
  constexpr int none = 4000;
  std::uint64_t largest = 0;
  int lowest = none;
  for (const Vec2& p : points) {
    for (int k = 0; k < 2; ++k) {
      const auto bits = std::bit_cast<std::uint64_t>(p[k]) & ~(std::uint64_t{1} << 63);
      largest = std::max(largest, bits);  // doubles of one sign are ordered as their bits are
      const int biased = static_cast<int>(bits >> 52);
      const int zeros = std::countr_zero(biased == 0 ? bits : bits | std::uint64_t{1} << 52);
      lowest = std::min(lowest, bits == 0 ? none : std::max(biased, 1) - 1075 + zeros);
    }
  }
  if (largest == 0) return {};
  return {lowest, std::ilogb(std::bit_cast<double>(largest))};
}

PlanePredicates::PlanePredicates(const BitRange& range) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double epsilon = 0x1p-53;
  orientation_error_ = range.safe() ? (3 + 16 * epsilon) * epsilon : infinity;
  circle_error_ = range.safe() ? (10 + 96 * epsilon) * epsilon : infinity;
  if (range.safe()) {
    orientation_exact_below_ = std::ldexp(1.0, 2 * range.lowest + 52);
    circle_exact_below_ = std::ldexp(1.0, 4 * range.lowest + 52);
  }
}

int PlanePredicates::orientation_close(const Vec2& a, const Vec2& b, const Vec2& c, double det,
                                       double magnitude) const {
  if (magnitude < orientation_exact_below_) return det > 0 ? 1 : det < 0 ? -1 : 0;
  if ((a[0] == c[0] && b[0] == c[0]) || (a[1] == c[1] && b[1] == c[1])) return 0;
  return orientation_exact(a, b, c);
}

int PlanePredicates::in_circle_close(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double det,
                                     double magnitude) const {
  if (magnitude < circle_exact_below_) return det > 0 ? 1 : det < 0 ? -1 : 0;
  // The corners of an axis-parallel rectangle, as on every grid: cocircular whatever the rounding of its lines.
  const auto two_lines = [&](int k) {
    return (a[k] == b[k] && c[k] == d[k]) || (a[k] == c[k] && b[k] == d[k]) || (a[k] == d[k] && b[k] == c[k]);
  };
  if (two_lines(0) && two_lines(1)) return 0;
  return in_circle_exact(a, b, c, d);
}

}  // namespace tri
