#pragma once

#include <string_view>
#include <variant>

#include "meshops/mesh.hpp"
#include "meshops/points/point_set.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What an operator works on. Between soup and mesh a pipeline converts by itself; points cannot become either, since
/// connecting them needs a model.
enum class Domain { points, soup, mesh };

/// "points", "soup" or "mesh", as `tri ops` has it.
std::string_view to_string(Domain domain);

/// What a pipeline carries from step to step.
using Geometry = std::variant<Soup, Mesh, PointSet>;

/// Which of the three it holds.
Domain domain_of(const Geometry& geometry);

}  // namespace tri
