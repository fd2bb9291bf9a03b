#include "libtri/alignment/surface_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "libtri/model/trim_region.hpp"
#include "meshops/for_each_block.hpp"
#include "meshops/random_stream.hpp"

namespace tri {
namespace {

constexpr int cells = 16;                // a side of a face's parameter box
constexpr std::size_t tries_each = 400;  // refusals for each wanted place before a face gets fewer

struct FaceSampler {
  explicit FaceSampler(const CadFace& face_in) : face(face_in), region(face_in) {
    du = (region.u_max() - region.u_min()) / cells;
    dv = (region.v_max() - region.v_min()) / cells;
    std::array<double, (cells + 1) * (cells + 1)> corner;
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i)
        corner[static_cast<std::size_t>(j * (cells + 1) + i)] =
            stretch(region.u_min() + du * i, region.v_min() + dv * j);
    double sum = 0;
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const double u = region.u_min() + du * i, v = region.v_min() + dv * j;
        double most = stretch(u + 0.5 * du, v + 0.5 * dv);
        for (const int k :
             {j * (cells + 1) + i, j * (cells + 1) + i + 1, (j + 1) * (cells + 1) + i, (j + 1) * (cells + 1) + i + 1})
          most = std::max(most, corner[static_cast<std::size_t>(k)]);
        if (region.classify(u, u + du, v, v + dv) == TrimRegion::Side::outside) most = 0;
        bound[static_cast<std::size_t>(j * cells + i)] = most;
        cumulative[static_cast<std::size_t>(j * cells + i)] = sum += most;
      }
    }
  }

  double stretch(double u, double v) const {
    const SurfacePoint s = face.surface->evaluate(u, v);
    const double length = (s.du % s.dv).norm();
    return std::isfinite(length) ? length : 0;
  }

  void draw(std::size_t wanted, RandomStream random, std::vector<Vec3>& points, std::vector<Vec3>& normals) const {
    const double sum = cumulative.back();
    if (!(sum > 0)) return;
    for (std::size_t tries = tries_each * wanted + 1000; points.size() < wanted && tries > 0; --tries) {
      const auto at = std::upper_bound(cumulative.begin(), cumulative.end(), random.uniform() * sum);
      const auto cell = std::min<std::ptrdiff_t>(at - cumulative.begin(), cells * cells - 1);
      const double u = region.u_min() + du * (static_cast<double>(cell % cells) + random.uniform());
      const double v = region.v_min() + dv * (static_cast<double>(cell / cells) + random.uniform());
      const double keep = random.uniform() * bound[static_cast<std::size_t>(cell)];
      if (!region.contains(u, v)) continue;
      const SurfacePoint s = face.surface->evaluate(u, v);
      const Vec3 normal = s.du % s.dv;
      const double length = normal.norm();
      if (!(length > keep) || !std::isfinite(s.p.sqrnorm())) continue;
      points.push_back(s.p);
      normals.push_back(normal / (face.reversed ? -length : length));
    }
  }

  const CadFace& face;
  TrimRegion region;
  double du = 0, dv = 0;
  std::array<double, cells * cells> bound{}, cumulative{};
};

}  // namespace

SurfaceSamples sample_surface(const CadModel& model, std::size_t count, std::uint64_t seed, const Context& context) {
  const std::size_t n = model.faces.size();
  double area = 0;
  for (const CadFace& face : model.faces) area += face.area;
  // Shares of the running sum, so that they add up to the count.
  std::vector<std::size_t> wanted(n, 0);
  double sum = 0;
  for (std::size_t f = 0; f < n && area > 0; ++f) {
    const auto share = [&](double x) {
      return static_cast<std::size_t>(std::floor(x / area * static_cast<double>(count) + 0.5));
    };
    wanted[f] = share(sum + model.faces[f].area) - share(sum);
    sum += model.faces[f].area;
  }
  std::vector<SurfaceSamples> per_face(n);
  for_each_block(context, "", n, 1, [&](std::size_t f, std::size_t, std::size_t) {
    if (wanted[f] > 0)
      FaceSampler(model.faces[f]).draw(wanted[f], RandomStream(seed, 1, f), per_face[f].points, per_face[f].normals);
  });
  SurfaceSamples all;
  for (std::size_t f = 0; f < n; ++f) {
    all.points.insert(all.points.end(), per_face[f].points.begin(), per_face[f].points.end());
    all.normals.insert(all.normals.end(), per_face[f].normals.begin(), per_face[f].normals.end());
    all.faces.insert(all.faces.end(), per_face[f].points.size(), static_cast<std::int32_t>(f));
  }
  return all;
}

}  // namespace tri
