#include "io/pictures/picture.hpp"

#include <png.h>

#include <csetjmp>

#include "io/atomic_file.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

void append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}

void flush(png_structp) {}

// Apart from its caller, because libpng leaves by longjmp, which must not pass over destructors.
bool encode(const Picture& picture, std::string& bytes, png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, &bytes, append, flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.width), static_cast<png_uint_32>(picture.height), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (int y = 0; y < picture.height; ++y) png_write_row(png, reinterpret_cast<png_const_bytep>(&picture.at(0, y)));
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

std::string encode_png(const Picture& picture) {
  if (picture.width < 1 || picture.height < 1) throw InvalidInput("a picture needs at least one pixel");
  const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (picture.pixels.size() != pixels)
    throw InvalidInput("a picture of " + std::to_string(picture.width) + " x " + std::to_string(picture.height) +
                       " has " + std::to_string(picture.pixels.size()) + " pixels");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info) {
    png_destroy_write_struct(&png, nullptr);
    throw Error("libpng cannot be started");
  }
  std::string bytes;
  const bool done = encode(picture, bytes, png, info);
  png_destroy_write_struct(&png, &info);
  if (!done) throw Error("libpng cannot encode the picture");
  return bytes;
}

void write_png(const std::string& path, const Picture& picture) {
  write_file(path, encode_png(picture));
}

}  // namespace tri
