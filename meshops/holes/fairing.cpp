#include "meshops/holes/fairing.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cmath>
#include <optional>
#include <unordered_map>

namespace tri {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Diagonal = Eigen::VectorXd;

/// The moving vertices and rings of vertices around them, numbered ring by ring.
class Region {
 public:
  Region(MeshView view, std::vector<VertexHandle> moving, int rings) : view_(view), vertices_(std::move(moving)) {
    for (std::size_t i = 0; i < vertices_.size(); ++i) number_[vertices_[i].idx()] = static_cast<int>(i);
    end_.push_back(static_cast<int>(vertices_.size()));
    for (int ring = 0, begin = 0; ring < rings; ++ring) {
      const int end = end_.back();
      for (int i = begin; i < end; ++i)
        for (auto it = view.mesh.cvv_iter(vertices_[i]); it.is_valid(); ++it)
          if (number_.try_emplace((*it).idx(), static_cast<int>(vertices_.size())).second) vertices_.push_back(*it);
      begin = end;
      end_.push_back(static_cast<int>(vertices_.size()));
    }
  }

  int size() const { return static_cast<int>(vertices_.size()); }
  int moving() const { return end_[0]; }
  int end_of_ring(int ring) const { return end_[ring]; }
  VertexHandle vertex(int i) const { return vertices_[i]; }
  int number(VertexHandle v) const { return number_.at(v.idx()); }
  const Vec3& point(int i) const { return view_.point(vertices_[i]); }

 private:
  MeshView view_;
  std::vector<VertexHandle> vertices_;
  std::vector<int> end_;
  std::unordered_map<int, int> number_;
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

/// The Laplacian's rows of the first `rows` vertices of the region; empty rows at the mesh's boundary.
Matrix laplacian(MeshView view, const Region& region, int rows, Weights& weights) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < rows; ++i) {
    if (view.mesh.is_boundary(region.vertex(i))) continue;
    double sum = 0;
    for (auto it = view.mesh.cvoh_iter(region.vertex(i)); it.is_valid(); ++it) {
      const double w = weights.of_edge(*it);
      entries.emplace_back(i, region.number(view.mesh.to_vertex_handle(*it)), w);
      sum += w;
    }
    entries.emplace_back(i, i, -sum);
  }
  Matrix result(rows, region.size());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Diagonal inverse_masses(MeshView view, const Region& region, int rows, Weights& weights) {
  Diagonal result(rows);
  for (int i = 0; i < rows; ++i)
    result[i] = view.mesh.is_boundary(region.vertex(i)) ? 0 : 1 / weights.of_vertex(region.vertex(i));
  return result;
}

/// The energy of differences of a function on the first `count` vertices along edges at the moving ones or their
/// neighbours.
Matrix differences(MeshView view, const Region& region, int inner, int count, Weights& weights) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < inner; ++i) {
    if (view.mesh.is_boundary(region.vertex(i))) continue;
    for (auto it = view.mesh.cvoh_iter(region.vertex(i)); it.is_valid(); ++it) {
      const VertexHandle to = view.mesh.to_vertex_handle(*it);
      const int j = region.number(to);
      if (view.mesh.is_boundary(to) || (j < inner && j < i)) continue;
      const double w = weights.of_edge(*it);
      entries.emplace_back(i, i, w);
      entries.emplace_back(j, j, w);
      entries.emplace_back(i, j, -w);
      entries.emplace_back(j, i, -w);
    }
  }
  Matrix result(count, count);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Solves a x = b; nothing if `a` is not positive definite or the solution does not fulfil the system.
std::optional<Rows> solve(const Matrix& a, const Rows& b) {
  const Eigen::SimplicialLDLT<Matrix> factors(a);
  if (factors.info() != Eigen::Success || !(factors.vectorD().minCoeff() > 0)) return std::nullopt;
  Rows x = factors.solve(b);
  Rows rest = b - a * x;
  // One step of refinement takes back what rounding left in ill-conditioned systems.
  x += factors.solve(rest);
  rest = b - a * x;
  if (!(rest.norm() <= 1e-6 * b.norm())) return std::nullopt;  // also if anything is not a number
  return x;
}

/// Moving vertices of parts that have a neighbour which stays.
std::vector<VertexHandle> with_rim(MeshView view, std::span<const VertexHandle> moving) {
  std::unordered_map<int, bool> seen;  // by moving vertex
  for (const VertexHandle v : moving) seen[v.idx()] = false;
  std::vector<VertexHandle> part;
  std::unordered_map<int, bool> kept;
  for (const VertexHandle start : moving) {
    if (seen[start.idx()]) continue;
    seen[start.idx()] = true;
    part.assign(1, start);
    bool rim = false;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (auto it = view.mesh.cvv_iter(part[i]); it.is_valid(); ++it) {
        const auto found = seen.find((*it).idx());
        if (found == seen.end()) {
          rim = true;
        } else if (!found->second) {
          found->second = true;
          part.push_back(*it);
        }
      }
    for (const VertexHandle v : part) kept[v.idx()] = rim;
  }
  std::vector<VertexHandle> result;
  for (const VertexHandle v : moving)
    if (kept[v.idx()]) result.push_back(v);
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
  FairedPoints result;
  result.vertices = with_rim(view, moving);
  result.without_rim = moving.size() - result.vertices.size();
  if (result.vertices.empty()) {
    result.outcome = FairingOutcome::nothing_to_move;
    return result;
  }
  // A row of the highest order reaches as many rings.
  const int order = continuity == Continuity::position ? 1 : continuity == Continuity::tangent ? 2 : 3;
  const Region region(view, result.vertices, order);
  const int n = region.moving(), rows = region.end_of_ring(order - 1);
  Weights weights(view, kind);
  const Matrix l = laplacian(view, region, rows, weights);

  // Coordinates from the middle of what stays, in units of its extent.
  Vec3 middle(0, 0, 0);
  for (int i = n; i < region.size(); ++i) middle += region.point(i) / (region.size() - n);
  double extent = 0;
  for (int i = n; i < region.size(); ++i) extent = std::max(extent, (region.point(i) - middle).norm());
  if (!(extent > 0)) extent = 1;
  Rows still = Rows::Zero(region.size(), 3);
  for (int i = n; i < region.size(); ++i)
    for (int k = 0; k < 3; ++k) still(i, k) = (region.point(i)[k] - middle[k]) / extent;

  Matrix system;
  Rows right;
  if (continuity == Continuity::position) {
    system = -l.leftCols(n);
    right = l * still;
  } else if (continuity == Continuity::tangent) {
    const Diagonal inverse = inverse_masses(view, region, rows, weights);
    const Matrix inner = l.leftCols(n), weighed = inverse.asDiagonal() * inner;
    system = inner.transpose() * weighed;
    right = -(weighed.transpose() * (l * still));
  } else {
    const Matrix y = inverse_masses(view, region, rows, weights).asDiagonal() * l;
    const Matrix inner = y.leftCols(n), k = differences(view, region, region.end_of_ring(1), rows, weights);
    const Matrix weighed = k * inner;
    system = inner.transpose() * weighed;
    right = -(weighed.transpose() * (y * still));
  }
  if (weights.failed()) {
    result.outcome = FairingOutcome::no_area;
    return result;
  }
  context.checkpoint();
  const std::optional<Rows> x = solve(system, right);
  context.checkpoint();
  if (!x) {
    result.outcome = FairingOutcome::singular;
    return result;
  }
  for (int i = 0; i < n; ++i) result.points.push_back(middle + extent * Vec3((*x)(i, 0), (*x)(i, 1), (*x)(i, 2)));
  return result;
}

}  // namespace tri
