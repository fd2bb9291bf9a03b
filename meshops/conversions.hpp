#pragma once

#include "meshops/context.hpp"
#include "meshops/geometry.hpp"
#include "meshops/report.hpp"

namespace tri {

/// `build_mesh` as a step of a pipeline: replaces the soup by its mesh. @throws as `build_mesh`; the soup is then as it
/// was.
Report build_mesh_step(Geometry& geometry, Context& context);

/// `to_soup` as a step of a pipeline: replaces the mesh by its soup. Elements marked as deleted do not come along; they
/// are counted in the figures "deleted vertices dropped" and "deleted faces dropped".
Report to_soup_step(Geometry& geometry, Context& context);

}  // namespace tri
