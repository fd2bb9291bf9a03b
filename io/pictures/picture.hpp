#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tri {

/// Red, green, blue in [0,255], sRGB.
using Color = std::array<std::uint8_t, 3>;

/// An image of `width` x `height` pixels, rows from top to bottom.
struct Picture {
  int width = 0;              ///< pixels
  int height = 0;             ///< pixels
  std::vector<Color> pixels;  ///< width * height entries

  /// The pixel in column x from the left and row y from the top, 0-based, inside of the picture.
  const Color& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
  /// The same, to be written to.
  Color& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// The picture as the bytes of a PNG file (8 bits a channel, RGB, no time stamp: equal pictures give equal bytes).
/// @throws InvalidInput if the picture has no pixel, or `pixels` has another size than width * height.
std::string encode_png(const Picture& picture);

/// Writes the picture as PNG; the file appears whole under its name or not at all.
/// @throws InvalidInput as `encode_png`; IoError if the file cannot be written.
void write_png(const std::string& path, const Picture& picture);

}  // namespace tri
