#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "io/pictures/picture.hpp"
#include "meshops/context.hpp"
#include "meshops/soup.hpp"

namespace tri {

/// How the colours of a picture are to be read.
enum class Palette {
  plain,       ///< one colour for every front
  colors,      ///< the file's own vertex colours
  categories,  ///< one colour for each whole number; grey for negative numbers and, for "cad_face", 0
  diverging,   ///< blue at -range, white at 0, red at +range
  sequential,  ///< dark violet at the low end to yellow at the high end
};

/// How a mesh is looked at and coloured.
struct RenderOptions {
  int width = 1200;             ///< pixels, 1 to 8192
  int height = 900;             ///< pixels, 1 to 8192
  Vec3 view{-0.55, -1.0, 0.7};  ///< direction from the part to the camera, any length but zero
  Vec3 up{0, 0, 1};             ///< what points upward in the picture; replaced by y where it is parallel to `view`
  bool perspective = false;     ///< else orthographic
  double zoom = 1;              ///< above 0; 1 frames the whole part, 2 shows half of it
  std::optional<Vec3> center;   ///< model point in the middle of the picture; the middle of the part's outline without
  bool edges = false;           ///< draw the edges of triangles, and rims (edges of a single triangle) in red
  bool smooth = false;          ///< shade by vertex normals where the surface is smooth; else every triangle is flat
  /// Name of the vertex or triangle scalar that gives the colour. "" takes the vertex colours, if there are any; "none"
  /// paints everything alike.
  std::string by;
  /// Overrides the choice that `render` describes; only the last three apply, and only with `by`.
  std::optional<Palette> palette;
  /// Far end of the palette in the scalar's unit, above 0: [-range, range] for the diverging, [0, range] for the
  /// sequential palette. Without, the 98th percentile of absolute values, and the 2nd to the 98th percentile.
  std::optional<double> range;
  Color background{255, 255, 255};  ///< RGB of pixels without a part
};

/// "plain", "colors", "categories", "diverging" or "sequential".
const char* name_of(Palette palette);

/// A picture and what it shows.
struct Rendering {
  Picture picture;                   ///< of the size that was asked for
  Palette palette = Palette::plain;  ///< the one that was used
  double low = 0;                    ///< value at the lower end of the palette, for `diverging` and `sequential`
  double high = 0;                   ///< value at its upper end
  std::size_t categories = 0;        ///< distinct numbers, for `categories`
  double covered = 0;                ///< share of the picture that shows the part, [0,1]
  double back = 0;                   ///< share of the covered part that shows backs of triangles, [0,1]
};

/// Draws the triangles of `soup` (its points as dots, if it has no triangle) with a light at the camera's shoulder.
///
/// Two-sided: backs of triangles (their vertices run clockwise) are tinted brown, so that a patch inside out stands
/// out. A scalar of whole numbers is coloured by category, one of both signs with a diverging palette, any other with a
/// sequential one. Four samples a pixel. The result does not depend on the number of threads. A cancel takes
/// effect between tiles of 64 x 64 pixels.
/// @throws InvalidInput if an option is out of range, no scalar has the name `by`, a coordinate is not finite, or there
/// is nothing to draw.
/// @throws Cancelled
Rendering render(const Soup& soup, const RenderOptions& options, Context& context);

}  // namespace tri
