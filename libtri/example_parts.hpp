#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "libtri/model/shape.hpp"

namespace tri {

/// What is known of an example part before it is built. The topology is that of its faces joined along shared edges.
struct ExamplePart {
  std::string name;         ///< as `example_part` takes it
  std::string description;  ///< one line for a person, with the size in mm
  int faces = 0;            ///< trimmed faces
  int components = 0;       ///< connected parts
  int loops = 0;            ///< closed loops of free edges; 0 for a closed solid
  int euler = 0;            ///< vertices - edges + faces of any triangulation
};

/// The parts that `example_part` builds, in the order of this table:
///
/// | name           | faces | components | loops | Euler | what it exercises                                          |
/// | -------------- | ----: | ---------: | ----: | ----: | ---------------------------------------------------------- |
/// | `boot-lid`     |    16 |          1 |     2 |     0 | the example of [Ristic et al. 2000]: trimmed NURBS only    |
/// | `blade`        |     5 |          1 |     1 |     1 | walls 0.6 to 2 mm apart, edge faces about 1 mm wide        |
/// | `bracket`      |    22 |          1 |     0 |    -6 | 1 mm sheet, cylindrical bends, four through holes          |
/// | `elbow`        |     5 |          1 |     2 |     0 | nothing but faces that close on themselves                 |
/// | `housing`      |    60 |          1 |     0 |     2 | planes, cylinders, tori; bosses with blind holes           |
/// | `sphere-cap`   |     1 |          1 |     1 |     1 | a pole: an edge without length in the middle of the face   |
/// | `fillet-block` |   100 |          1 |     0 |     2 | 72 fillets 1.3 or 2.4 mm wide on a block of 160 x 100 mm   |
std::vector<ExamplePart> example_parts();

/// Builds an example part, in millimetres: a solid where the table says 0 loops, else one shell. Every face and the
/// whole pass OpenCASCADE's validity check; normals of solids point outward, those of shells to the side that is seen.
///
/// Each call builds a new shape (the lid takes about a second), so that callers share nothing.
/// @throws InvalidInput for an unknown name, listing the known ones; CadError if OpenCASCADE fails to build it.
Shape example_part(std::string_view name);

}  // namespace tri
