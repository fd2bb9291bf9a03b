#include "meshops/holes/fairing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "meshops/holes/sparse_cholesky.hpp"
#include "meshops/pace.hpp"
#include "meshops/search/number_map.hpp"

namespace tri {
namespace {

/// The moving vertices and rings of vertices around them, numbered ring by ring.
class Region {
 public:
  Region(MeshView view, std::vector<VertexHandle> moving, int rings, Pace& pace)
      : view_(view), vertices_(std::move(moving)), number_(vertices_.size()) {
    for (std::size_t i = 0; i < vertices_.size(); ++i, pace())
      number_.insert(static_cast<std::uint32_t>(vertices_[i].idx()), static_cast<std::uint32_t>(i));
    end_.push_back(static_cast<int>(vertices_.size()));
    for (int ring = 0, begin = 0; ring < rings; ++ring) {
      const int end = end_.back();
      for (int i = begin; i < end; ++i, pace())
        for (auto it = view.mesh.cvv_iter(vertices_[i]); it.is_valid(); ++it)
          if (number_.insert(static_cast<std::uint32_t>((*it).idx()), static_cast<std::uint32_t>(vertices_.size()))
                  .second)
            vertices_.push_back(*it);
      begin = end;
      end_.push_back(static_cast<int>(vertices_.size()));
    }
  }

  int size() const { return static_cast<int>(vertices_.size()); }
  int moving() const { return end_[0]; }
  int end_of_ring(int ring) const { return end_[ring]; }
  VertexHandle vertex(int i) const { return vertices_[i]; }
  int number(VertexHandle v) const { return static_cast<int>(number_.find(static_cast<std::uint32_t>(v.idx()))); }
  const Vec3& point(int i) const { return view_.point(vertices_[i]); }

 private:
  MeshView view_;
  std::vector<VertexHandle> vertices_;
  std::vector<int> end_;
  NumberMap<std::uint32_t> number_;
};

class Weights {
 public:
  Weights(MeshView view, FairingWeights kind) : view_(view), kind_(kind) {}

  bool failed() const { return failed_; }

  double of_edge(HalfedgeHandle h) {
    if (kind_ == FairingWeights::uniform) return 1;
    return 0.5 * (cotangent(h) + cotangent(view_.mesh.opposite_halfedge_handle(h)));
  }

  double of_vertex(VertexHandle v) {
    double sum = 0;
    for (auto it = view_.mesh.cvoh_iter(v); it.is_valid(); ++it) {
      if (kind_ == FairingWeights::uniform)
        sum += 1;
      else if (!view_.mesh.is_boundary(*it))
        sum += across(*it).norm() / 6;
    }
    failed_ = failed_ || !(sum > 0);
    return sum;
  }

 private:
  Vec3 across(HalfedgeHandle h) const {
    const Vec3 &a = from(h), &b = to(h), &c = to(view_.mesh.next_halfedge_handle(h));
    return (a - c) % (b - c);
  }
  /// Of the angle opposite to a half-edge, in its triangle.
  double cotangent(HalfedgeHandle h) {
    if (view_.mesh.is_boundary(h)) return 0;
    const Vec3 &a = from(h), &b = to(h), &c = to(view_.mesh.next_halfedge_handle(h));
    const double dot = (a - c) | (b - c), cross = across(h).norm();
    failed_ = failed_ || !(cross > 1e-10 * std::abs(dot));
    return dot / cross;
  }
  const Vec3& from(HalfedgeHandle h) const { return view_.point(view_.mesh.from_vertex_handle(h)); }
  const Vec3& to(HalfedgeHandle h) const { return view_.point(view_.mesh.to_vertex_handle(h)); }

  MeshView view_;
  FairingWeights kind_;
  bool failed_ = false;
};

/// A sparse matrix by rows is kept as the columns of what it is turned over.
using SparseRows = SparseColumns;
using Column = std::vector<double>;
using Points = SparseCholesky::Rows;

/// Rows of a matrix that are collected entry by entry, in any order; those in one place are added up in that order.
class RowCollector {
 public:
  void add(std::int32_t column, double value) {
    if (const auto c = static_cast<std::size_t>(column); c >= place_.size()) place_.resize(c + 1, -1);
    if (place_[column] < 0) {
      place_[column] = static_cast<std::int32_t>(entries_.size());
      entries_.push_back({column, value});
    } else {
      entries_[place_[column]].value += value;
    }
  }
  void end_row(SparseRows& rows) {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) { return a.column < b.column; });
    for (const Entry& e : entries_) {
      rows.add(e.column, e.value);
      place_[e.column] = -1;
    }
    entries_.clear();
    rows.end_column();
  }

 private:
  struct Entry {
    std::int32_t column;
    double value;
  };
  std::vector<Entry> entries_;
  std::vector<std::int32_t> place_;  ///< of a column's entry; below 0 if there is none
};

/// Calls `visit(row, value)` for the entries of a column.
template <class Visit>
void for_entries(const SparseColumns& a, std::int32_t column, const Visit& visit) {
  for (std::int64_t p = a.first[column]; p < a.first[column + 1]; ++p) visit(a.row[p], a.value[p]);
}

/// The Laplacian's rows of the first `rows` vertices of the region; empty rows at the mesh's boundary.
SparseRows laplacian(MeshView view, const Region& region, int rows, Weights& weights, Pace& pace) {
  SparseRows result;
  RowCollector row;
  for (int i = 0; i < rows; ++i, pace()) {
    if (!view.mesh.is_boundary(region.vertex(i))) {
      double sum = 0;
      for (auto it = view.mesh.cvoh_iter(region.vertex(i)); it.is_valid(); ++it) {
        const double w = weights.of_edge(*it);
        row.add(region.number(view.mesh.to_vertex_handle(*it)), w);
        sum += w;
      }
      row.add(i, -sum);
    }
    row.end_row(result);
  }
  return result;
}

Column inverse_masses(MeshView view, const Region& region, int rows, Weights& weights, Pace& pace) {
  Column result;
  for (int i = 0; i < rows; ++i, pace())
    result.push_back(view.mesh.is_boundary(region.vertex(i)) ? 0 : 1 / weights.of_vertex(region.vertex(i)));
  return result;
}

/// The energy of differences of a function on the first `count` vertices along edges at the moving ones or their
/// neighbours. Symmetric.
SparseColumns differences(MeshView view, const Region& region, int inner, int count, Weights& weights, Pace& pace) {
  struct Entry {
    int row, column;
    double value;
  };
  std::vector<Entry> entries;
  for (int i = 0; i < inner; ++i, pace()) {
    if (view.mesh.is_boundary(region.vertex(i))) continue;
    for (auto it = view.mesh.cvoh_iter(region.vertex(i)); it.is_valid(); ++it) {
      const VertexHandle to = view.mesh.to_vertex_handle(*it);
      const int j = region.number(to);
      if (view.mesh.is_boundary(to) || (j < inner && j < i)) continue;
      const double w = weights.of_edge(*it);
      for (const Entry& e : {Entry{i, i, w}, Entry{j, j, w}, Entry{i, j, -w}, Entry{j, i, -w}}) entries.push_back(e);
    }
  }
  // By rows, in the order in which they came.
  std::vector<std::size_t> end(static_cast<std::size_t>(count) + 1, 0);
  for (const Entry& e : entries) pace(), ++end[static_cast<std::size_t>(e.row) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::size_t> order(entries.size());
  for (std::size_t k = 0; k < entries.size(); ++k) pace(), order[end[static_cast<std::size_t>(entries[k].row)]++] = k;
  SparseColumns result;
  RowCollector row;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i, pace()) {
    for (; k < end[static_cast<std::size_t>(i)]; ++k) row.add(entries[order[k]].column, entries[order[k]].value);
    row.end_row(result);
  }
  return result;
}

/// The first `columns` columns of a matrix that is given by rows.
SparseColumns columns_of(const SparseRows& rows, std::int32_t columns, Pace& pace) {
  SparseColumns result;
  result.first.assign(static_cast<std::size_t>(columns) + 1, 0);
  for (const std::int32_t c : rows.row) {
    pace();
    if (c < columns) ++result.first[c + 1];
  }
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.row.resize(static_cast<std::size_t>(result.first.back()));
  result.value.resize(result.row.size());
  std::vector<std::int64_t> next(result.first.begin(), result.first.end() - 1);
  for (std::int32_t r = 0; r < rows.columns(); ++r, pace())
    for_entries(rows, r, [&](std::int32_t c, double value) {
      if (c >= columns) return;
      result.row[next[c]] = r;
      result.value[next[c]++] = value;
    });
  return result;
}

/// a b, where a is given by its columns, and of which only rows below `rows` are wanted.
SparseColumns product(const SparseColumns& a, const SparseColumns& b, std::int32_t rows, Pace& pace) {
  SparseColumns result;
  RowCollector column;
  for (std::int32_t j = 0; j < b.columns(); ++j) {
    for_entries(b, j, [&](std::int32_t m, double y) {
      pace();
      for_entries(a, m, [&](std::int32_t i, double x) {
        if (i < rows) column.add(i, x * y);
      });
    });
    column.end_row(result);
  }
  return result;
}

SparseColumns weighed_rows(SparseColumns a, const Column& weights) {
  for (std::size_t p = 0; p < a.row.size(); ++p) a.value[p] *= weights[static_cast<std::size_t>(a.row[p])];
  return a;
}

/// For each column of the matrix, or each row if it is given by rows: its product with points.
Points products(const SparseColumns& a, const Points& points, Pace& pace) {
  Points result;
  for (std::int32_t j = 0; j < a.columns(); ++j, pace()) {
    Vec3 sum(0, 0, 0);
    for_entries(a, j, [&](std::int32_t i, double x) { sum += points[static_cast<std::size_t>(i)] * x; });
    result.push_back(sum);
  }
  return result;
}

double norm_of(const Points& points) {
  double sum = 0;
  for (const Vec3& p : points) sum += p.sqrnorm();
  return std::sqrt(sum);
}

/// Solves a x = b; nothing if `a` is not positive definite or the solution does not fulfil the system.
std::optional<Points> solve(const SparseColumns& a, const Points& b, const Context& context) {
  Pace pace(context);
  const SparseCholesky factors(a, context);
  if (!factors.positive_definite()) return std::nullopt;
  const auto rest_of = [&](const Points& x) {
    Points rest = b;
    for (std::int32_t j = 0; j < a.columns(); ++j, pace())
      for_entries(a, j, [&, xj = x[static_cast<std::size_t>(j)]](std::int32_t i, double value) {
        rest[static_cast<std::size_t>(i)] -= xj * value;
      });
    return rest;
  };
  Points x = factors.solve(b, context);
  // One step of refinement takes back what rounding left in ill-conditioned systems.
  const Points more = factors.solve(rest_of(x), context);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += more[i];
  if (!(norm_of(rest_of(x)) <= 1e-6 * norm_of(b))) return std::nullopt;  // also if anything is not a number
  return x;
}

/// Moving vertices of parts that have a neighbour which stays.
std::vector<VertexHandle> with_rim(MeshView view, std::span<const VertexHandle> moving, Pace& pace) {
  NumberMap<std::uint32_t> place(moving.size());
  for (std::size_t i = 0; i < moving.size(); ++i, pace())
    place.insert(static_cast<std::uint32_t>(moving[i].idx()), static_cast<std::uint32_t>(i));
  std::vector<char> seen(moving.size(), 0), kept(moving.size(), 0);
  std::vector<std::uint32_t> part;
  for (std::uint32_t start = 0; start < moving.size(); ++start) {
    if (seen[start]) continue;
    seen[start] = 1;
    part.assign(1, start);
    bool rim = false;
    for (std::size_t i = 0; i < part.size(); ++i, pace())
      for (auto it = view.mesh.cvv_iter(moving[part[i]]); it.is_valid(); ++it) {
        const std::uint32_t other = place.find(static_cast<std::uint32_t>((*it).idx()));
        if (other == no_index) {
          rim = true;
        } else if (!seen[other]) {
          seen[other] = 1;
          part.push_back(other);
        }
      }
    for (const std::uint32_t i : part) kept[i] = rim;
  }
  std::vector<VertexHandle> result;
  for (std::size_t i = 0; i < moving.size(); ++i)
    if (kept[i]) result.push_back(moving[i]);
  return result;
}

}  // namespace

std::string_view to_string(FairingOutcome outcome) {
  switch (outcome) {
    case FairingOutcome::done:
      return "done";
    case FairingOutcome::nothing_to_move:
      return "nothing to move";
    case FairingOutcome::no_area:
      return "triangle without area";
    case FairingOutcome::singular:
      return "system is singular";
  }
  return "";
}

FairedPoints faired_points(MeshView view, std::span<const VertexHandle> moving, Continuity continuity,
                           FairingWeights kind, const Context& context) {
  context.checkpoint();
  Pace pace(context);
  FairedPoints result;
  result.vertices = with_rim(view, moving, pace);
  result.without_rim = moving.size() - result.vertices.size();
  if (result.vertices.empty()) {
    result.outcome = FairingOutcome::nothing_to_move;
    return result;
  }
  // A row of the highest order reaches as many rings.
  const int order = continuity == Continuity::position ? 1 : continuity == Continuity::tangent ? 2 : 3;
  const Region region(view, result.vertices, order, pace);
  const int n = region.moving(), rows = region.end_of_ring(order - 1);
  Weights weights(view, kind);
  SparseRows l = laplacian(view, region, rows, weights, pace);

  // Coordinates from the middle of what stays, in units of its extent.
  Vec3 middle(0, 0, 0);
  for (int i = n; i < region.size(); ++i) middle += region.point(i) / (region.size() - n);
  double extent = 0;
  for (int i = n; i < region.size(); ++i) extent = std::max(extent, (region.point(i) - middle).norm());
  if (!(extent > 0)) extent = 1;
  Points still(static_cast<std::size_t>(region.size()), Vec3(0, 0, 0));
  for (int i = n; i < region.size(); ++i) still[static_cast<std::size_t>(i)] = (region.point(i) - middle) / extent;

  SparseColumns system;
  Points right;
  const SparseColumns inner = columns_of(l, n, pace);
  if (continuity == Continuity::position) {
    system = inner;
    for (double& x : system.value) x = -x;
    right = products(l, still, pace);
  } else if (continuity == Continuity::tangent) {
    const SparseColumns weighed = weighed_rows(inner, inverse_masses(view, region, rows, weights, pace));
    system = product(l, weighed, n, pace);
    right = products(weighed, products(l, still, pace), pace);
  } else {
    const Column inverse = inverse_masses(view, region, rows, weights, pace);
    for (std::int32_t r = 0; r < rows; ++r, pace())
      for (std::int64_t p = l.first[r]; p < l.first[r + 1]; ++p) l.value[p] *= inverse[static_cast<std::size_t>(r)];
    const SparseColumns k = differences(view, region, region.end_of_ring(1), rows, weights, pace);
    const SparseColumns weighed = product(k, weighed_rows(inner, inverse), rows, pace);
    system = product(l, weighed, n, pace);
    right = products(weighed, products(l, still, pace), pace);
  }
  if (continuity != Continuity::position)
    for (Vec3& p : right) p = -p;
  if (weights.failed()) {
    result.outcome = FairingOutcome::no_area;
    return result;
  }
  context.checkpoint();
  const std::optional<Points> x = solve(system, right, context);
  if (!x) {
    result.outcome = FairingOutcome::singular;
    return result;
  }
  for (const Vec3& p : *x) result.points.push_back(middle + extent * p);
  return result;
}

}  // namespace tri
