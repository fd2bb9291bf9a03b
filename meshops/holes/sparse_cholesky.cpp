#include "meshops/holes/sparse_cholesky.hpp"

#include <algorithm>
#include <numeric>

namespace tri {
namespace {

constexpr std::uint32_t steps_between_looks = 1 << 21;  // of a few ns

/// Reaches a checkpoint after so many steps, which come in lots of any size.
class StepCount {
 public:
  explicit StepCount(const Context& context) : context_(context) {}
  void operator()(std::int64_t steps) {
    done_ += steps;
    if (done_ < steps_between_looks) return;
    done_ = 0;
    context_.checkpoint();
  }

 private:
  const Context& context_;
  std::int64_t done_ = 0;
};

}  // namespace

SparseCholesky::SparseCholesky(const SparseColumns& a, const Context& context, const EliminationLimits& limits)
    : order_(elimination_order(a, context, limits)) {
  const SparseColumns upper = permuted(a, context);
  analyse(upper, context);
  factorise(upper, context);
}

/// The upper triangle of the matrix in the order of elimination; rows in no order.
SparseColumns SparseCholesky::permuted(const SparseColumns& a, const Context& context) const {
  StepCount steps(context);
  const std::int32_t n = a.columns();
  std::vector<std::int32_t> place(static_cast<std::size_t>(n));
  for (std::int32_t k = 0; k < n; ++k) place[order_[k]] = k;
  SparseColumns upper;
  upper.first.assign(static_cast<std::size_t>(n) + 1, 0);
  const auto for_lower = [&](const auto& visit) {
    for (std::int32_t j = 0; j < n; ++j) {
      steps(4 * (a.first[j + 1] - a.first[j]));
      for (std::int64_t p = a.first[j]; p < a.first[j + 1]; ++p)
        if (a.row[p] >= j) visit(std::minmax(place[a.row[p]], place[j]), a.value[p]);
    }
  };
  for_lower([&](const auto& at, double) { ++upper.first[at.second + 1]; });
  std::partial_sum(upper.first.begin(), upper.first.end(), upper.first.begin());
  upper.row.resize(static_cast<std::size_t>(upper.first.back()));
  upper.value.resize(upper.row.size());
  std::vector<std::int64_t> next(upper.first.begin(), upper.first.end() - 1);
  for_lower([&](const auto& at, double value) {
    const std::int64_t p = next[at.second]++;
    upper.row[p] = at.first;
    upper.value[p] = value;
  });
  return upper;
}

/// The elimination tree, and how long the columns of L are.
void SparseCholesky::analyse(const SparseColumns& upper, const Context& context) {
  StepCount steps(context);
  const std::int32_t n = upper.columns();
  parent_.assign(static_cast<std::size_t>(n), -1);
  first_.assign(static_cast<std::size_t>(n) + 1, 0);
  std::vector<std::int32_t> seen(static_cast<std::size_t>(n), -1);
  for (std::int32_t k = 0; k < n; ++k) {
    seen[k] = k;
    std::int64_t walked = 0;
    for (std::int64_t p = upper.first[k]; p < upper.first[k + 1]; ++p)
      for (std::int32_t i = upper.row[p]; seen[i] != k; i = parent_[i]) {
        if (parent_[i] < 0) parent_[i] = k;
        ++first_[i + 1];
        seen[i] = k;
        ++walked;
      }
    steps(4 * walked + 8);
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

void SparseCholesky::factorise(const SparseColumns& upper, const Context& context) {
  StepCount steps(context);
  const std::int32_t n = upper.columns();
  rows_ = std::make_unique_for_overwrite<std::int32_t[]>(static_cast<std::size_t>(first_.back()));
  values_ = std::make_unique_for_overwrite<double[]>(static_cast<std::size_t>(first_.back()));
  std::int32_t* const rows = rows_.get();
  double* const values = values_.get();
  std::vector<std::int64_t> end(first_.begin(), first_.end() - 1);
  std::vector<double> y(static_cast<std::size_t>(n), 0);
  std::vector<std::int32_t> pattern(static_cast<std::size_t>(n)), seen(static_cast<std::size_t>(n), -1);
  diagonal_.resize(static_cast<std::size_t>(n));
  for (std::int32_t k = 0; k < n; ++k) {
    // Where row k of L has entries, every one before those that depend on it.
    std::int32_t top = n;
    seen[k] = k;
    for (std::int64_t p = upper.first[k]; p < upper.first[k + 1]; ++p) {
      std::int32_t i = upper.row[p], length = 0;
      y[i] += upper.value[p];
      for (; seen[i] != k; i = parent_[i]) pattern[length++] = i, seen[i] = k;
      while (length > 0) pattern[--top] = pattern[--length];
    }
    double d = y[k];
    y[k] = 0;
    for (; top < n; ++top) {
      const std::int32_t i = pattern[top];
      const double yi = y[i], entry = yi / diagonal_[i];
      y[i] = 0;
      const std::int64_t last = end[i]++;
      for (std::int64_t p = first_[i]; p < last; ++p) y[rows[p]] -= values[p] * yi;
      d -= entry * yi;
      rows[last] = k;
      values[last] = entry;
      steps(last - first_[i] + 8);
    }
    diagonal_[k] = d;
    if (!(d > 0)) return;
  }
  positive_definite_ = true;
}

SparseCholesky::Rows SparseCholesky::solve(const Rows& b, const Context& context) const {
  StepCount steps(context);
  const std::int32_t n = static_cast<std::int32_t>(order_.size());
  const std::int32_t* const rows = rows_.get();
  const double* const values = values_.get();
  Rows x(b.size());
  for (std::int32_t k = 0; k < n; ++k) x[k] = b[order_[k]];
  for (std::int32_t k = 0; k < n; ++k) {
    const Vec3 xk = x[k];
    for (std::int64_t p = first_[k]; p < first_[k + 1]; ++p) x[rows[p]] -= xk * values[p];
    steps(4 * (first_[k + 1] - first_[k]));
  }
  for (std::int32_t k = 0; k < n; ++k) x[k] *= 1 / diagonal_[k];
  for (std::int32_t k = n - 1; k >= 0; --k) {
    Vec3 xk = x[k];
    for (std::int64_t p = first_[k]; p < first_[k + 1]; ++p) xk -= x[rows[p]] * values[p];
    x[k] = xk;
    steps(4 * (first_[k + 1] - first_[k]));
  }
  Rows result(b.size());
  for (std::int32_t k = 0; k < n; ++k) result[order_[k]] = x[k];
  return result;
}

}  // namespace tri
