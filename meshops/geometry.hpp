#pragma once

#include <string_view>
#include <variant>

#include "meshops/mesh.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// What an operator works on. Points are a soup without triangles.
enum class Domain { points, soup, mesh };

std::string_view to_string(Domain domain);

/// What a pipeline carries from step to step.
using Geometry = std::variant<Soup, Mesh>;

}  // namespace tri
