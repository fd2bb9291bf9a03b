#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "meshops/context.hpp"
#include "meshops/holes/elimination_order.hpp"
#include "meshops/vec.hpp"

namespace tri {

/// A sparse matrix by columns; within each, rows ascend.
struct SparseColumns {
  std::vector<std::int64_t> first{0};  ///< of each column, in `row` and `value`; and the end
  std::vector<std::int32_t> row;       ///< of each entry
  std::vector<double> value;           ///< the same

  /// Number of columns.
  std::int32_t columns() const { return static_cast<std::int32_t>(first.size()) - 1; }
  /// Appends an entry to the last column, which `end_column` ends.
  void add(std::int32_t in_row, double x) { row.push_back(in_row), value.push_back(x); }
  /// What is added from now on belongs to the next column.
  void end_column() { first.push_back(static_cast<std::int64_t>(row.size())); }
};

/// The factors of a symmetric matrix, L D L^T, found row by row of L [Davis, Direct Methods for Sparse Linear Systems,
/// 2006, chapter 4]. Unlike Eigen's, it can be cancelled while it works. `elimination_order` says in which order.
class SparseCholesky {
 public:
  /// Of the right side and the solution: one place for each unknown.
  using Rows = std::vector<Vec3>;

  /// @param a  symmetric, of which the lower triangle counts; the pattern is symmetric
  /// @throws Cancelled within some 80 ms; bad_alloc where the factors do not fit into memory
  SparseCholesky(const SparseColumns& a, const Context& context, const EliminationLimits& limits = {});

  /// Whether the matrix is positive definite, as far as rounding can tell. If not, there is no `solve`.
  bool positive_definite() const { return positive_definite_; }

  /// @return x with a x = b @throws Cancelled
  Rows solve(const Rows& b, const Context& context) const;

 private:
  SparseColumns permuted(const SparseColumns& a, const Context& context) const;
  void analyse(const SparseColumns& upper, const Context& context);
  void factorise(const SparseColumns& upper, const Context& context);

  std::vector<std::int32_t> order_;   ///< which unknown comes where
  std::vector<std::int32_t> parent_;  ///< in the elimination tree
  // L without its diagonal of ones. Not vectors, which would be filled first, all at once.
  std::vector<std::int64_t> first_;  ///< of each column
  std::unique_ptr<std::int32_t[]> rows_;
  std::unique_ptr<double[]> values_;
  std::vector<double> diagonal_;  ///< D
  bool positive_definite_ = false;
};

}  // namespace tri
