#pragma once

// Included only by the source files that wrap OpenCASCADE.
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <memory>

#include "libtri/surfaces/curve.hpp"
#include "libtri/surfaces/surface.hpp"

namespace tri {

/// The flat evaluator with the same parameterisation. Transform the surface by its face's location before.
/// @throws CadError for a type no evaluator exists for, or data that is not valid (weights that are not positive).
std::shared_ptr<const Surface> make_surface(const Handle(Geom_Surface) & surface);

/// The flat evaluator with the same parameterisation; `first` and `last` only say which part will be used.
/// @throws CadError as `make_surface`.
std::shared_ptr<const Curve2> make_curve2(const Handle(Geom2d_Curve) & curve, double first, double last);

/// @throws CadError as `make_surface`.
std::shared_ptr<const Curve3> make_curve3(const Handle(Geom_Curve) & curve);

}  // namespace tri
