#include "meshops/shape/curvature_flow.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "meshops/for_each_block.hpp"

namespace tri {
namespace {

constexpr std::size_t flow_block = 4096;
constexpr double largest_weight = 1000;
constexpr double accuracy = 1e-4;
constexpr int most_solver_rounds = 300;

/// Cotangent of the angle at c; at most `largest_weight` either way, also where the triangle has no area.
double cotangent(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = a - c, v = b - c;
  const double dot = u | v, cross = (u % v).norm();
  if (!(std::abs(dot) < largest_weight * cross)) return dot > 0 ? largest_weight : dot < 0 ? -largest_weight : 0;
  return dot / cross;
}

double twice_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return ((b - a) % (c - a)).norm();
}

}  // namespace

CurvatureFlow::CurvatureFlow(MeshView view, const VertexRows& rows, std::span<const Part> parts)
    : view_(view), rows_(rows), parts_(parts), any_line_(std::ranges::count(parts, Part::line) > 0) {
  const std::size_t vertices = parts.size();
  weights_.resize(rows.neighbor.size());
  cotangents_.resize(view.mesh.n_halfedges());
  mass_.resize(vertices);
  diagonal_.resize(vertices);
  const Vec3 zero(0, 0, 0);
  step_.resize(vertices);
  residual_.resize(vertices);
  direction_.assign(vertices, zero);
  image_.resize(vertices);
}

void CurvatureFlow::step(std::vector<Vec3>& points, double time, const Context& context) {
  if (any_line_) solve(Part::line, points, time, context);
  solve(Part::surface, points, time, context);
}

/// Fills the entries of M + t K in the rows of `part`.
void CurvatureFlow::weigh(Part part, const std::vector<Vec3>& points, double time, const Context& context) {
  const OpenMesh::TriConnectivity& mesh = view_.mesh;
  if (part == Part::surface) {
    for_each_block(
        context, "", cotangents_.size(), 2 * flow_block, [&](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const HalfedgeHandle h(static_cast<int>(i));
            cotangents_[i] = 0;
            if (mesh.status(mesh.edge_handle(h)).deleted() || mesh.is_boundary(h)) continue;
            cotangents_[i] = cotangent(points[mesh.from_vertex_handle(h).idx()], points[mesh.to_vertex_handle(h).idx()],
                                       points[mesh.to_vertex_handle(mesh.next_halfedge_handle(h)).idx()]);
            // Corners without a place make no weight.
            if (std::isnan(cotangents_[i])) cotangents_[i] = 0;
          }
        });
  }
  const double largest_line_weight = largest_weight / std::sqrt(time);
  for_each_block(context, "", parts_.size(), flow_block, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (parts_[i] != part) continue;
      double mass = 0, sum = 0;
      for (std::uint32_t k = rows_.begin[i]; k < rows_.begin[i + 1]; ++k) {
        const Vec3& neighbor = points[rows_.neighbor[k]];
        const std::uint32_t h = rows_.halfedge[k];
        double weight = 0;
        if (part == Part::line) {
          const double length = (neighbor - points[i]).norm();
          mass += length / 2;
          weight = length > 0 ? std::min(1 / length, largest_line_weight) : 0;
        } else {
          weight = std::clamp((cotangents_[h] + cotangents_[h ^ 1]) / 2, 0.0, largest_weight);
          const HalfedgeHandle out(static_cast<int>(h));
          if (!mesh.is_boundary(out)) {
            const double area =
                twice_area(points[i], neighbor, points[mesh.to_vertex_handle(mesh.next_halfedge_handle(out)).idx()]) /
                6;
            if (std::isfinite(area)) mass += area;
          }
        }
        weights_[k] = time * weight;
        sum += weights_[k];
      }
      mass_[i] = mass;
      diagonal_[i] = mass + sum;
    }
  });
}

/// Sums what `body` adds up over blocks of vertices, in the order of the blocks.
Vec3 CurvatureFlow::sum_over(const Context& context, const std::function<void(std::size_t, std::size_t, Vec3&)>& body) {
  std::vector<Vec3> sums((parts_.size() + flow_block - 1) / flow_block, Vec3(0, 0, 0));
  for_each_block(context, "", parts_.size(), flow_block,
                 [&](std::size_t block, std::size_t begin, std::size_t end) { body(begin, end, sums[block]); });
  Vec3 total(0, 0, 0);
  for (const Vec3& sum : sums) total += sum;
  return total;
}

/// Conjugate gradients with the diagonal as preconditioner, on the step x' - x, so that a coordinate in which there is
/// nothing to do stays as it is. Outside of `part` every vector is zero.
void CurvatureFlow::solve(Part part, std::vector<Vec3>& points, double time, const Context& context) {
  weigh(part, points, time, context);
  const Vec3 zero(0, 0, 0);
  Vec3 error = sum_over(context, [&](std::size_t begin, std::size_t end, Vec3& sum) {
    for (std::size_t i = begin; i < end; ++i) {
      step_[i] = residual_[i] = direction_[i] = zero;
      if (parts_[i] != part || !(diagonal_[i] > 0)) continue;
      for (std::uint32_t k = rows_.begin[i]; k < rows_.begin[i + 1]; ++k)
        residual_[i] += weights_[k] * (points[rows_.neighbor[k]] - points[i]);
      direction_[i] = residual_[i] / diagonal_[i];
      sum += residual_[i] * direction_[i];
    }
  });
  const Vec3 enough = error * (accuracy * accuracy);
  const auto unfinished = [&] { return error[0] > enough[0] || error[1] > enough[1] || error[2] > enough[2]; };
  for (int round = 0; round < most_solver_rounds && unfinished(); ++round) {
    const Vec3 energy = sum_over(context, [&](std::size_t begin, std::size_t end, Vec3& sum) {
      for (std::size_t i = begin; i < end; ++i) {
        if (parts_[i] != part) continue;
        Vec3 image = mass_[i] * direction_[i];
        for (std::uint32_t k = rows_.begin[i]; k < rows_.begin[i + 1]; ++k)
          image += weights_[k] * (direction_[i] - direction_[rows_.neighbor[k]]);
        image_[i] = image;
        sum += direction_[i] * image;
      }
    });
    Vec3 share = zero;
    for (int k = 0; k < 3; ++k)
      if (energy[k] > 0) share[k] = error[k] / energy[k];
    const Vec3 next = sum_over(context, [&](std::size_t begin, std::size_t end, Vec3& sum) {
      for (std::size_t i = begin; i < end; ++i) {
        if (parts_[i] != part || !(diagonal_[i] > 0)) continue;
        step_[i] += share * direction_[i];
        residual_[i] -= share * image_[i];
        sum += residual_[i] * residual_[i] / diagonal_[i];
      }
    });
    Vec3 keep = zero;
    for (int k = 0; k < 3; ++k)
      if (error[k] > 0) keep[k] = next[k] / error[k];
    error = next;
    for_each_block(context, "", parts_.size(), flow_block, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (parts_[i] == part && diagonal_[i] > 0) direction_[i] = residual_[i] / diagonal_[i] + keep * direction_[i];
    });
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    if (parts_[i] == part) points[i] += step_[i];
}

}  // namespace tri
