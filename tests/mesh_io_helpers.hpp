#pragma once

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "io/mesh_file.hpp"
#include "meshops/error.hpp"
#include "temporary_folder.hpp"

namespace tri::test {

inline Soup parsed(const std::string& bytes, const std::string& name, MeshFileInfo* info = nullptr) {
  Context context;
  return parse_mesh(bytes, name, context, info);
}

/// Parses what must be refused and returns the error.
inline IoError refused(const std::string& bytes, const std::string& name) {
  Context context;
  try {
    parse_mesh(bytes, name, context);
  } catch (const IoError& error) {
    return error;
  }
  FAIL("accepted: " << bytes.substr(0, 200));
  return {"", ""};
}

/// The raw bytes of values, in this machine's (little endian) order or reversed.
template <class... Values>
std::string raw(Values... values) {
  std::string out;
  ((out.append(reinterpret_cast<const char*>(&values), sizeof values)), ...);
  return out;
}
template <class... Values>
std::string raw_big(Values... values) {
  std::string out;
  ((out +=
    [](auto v) {
      const std::string little = raw(v);
      return std::string(little.rbegin(), little.rend());
    }(values)),
   ...);
  return out;
}

inline bool has_note(const std::vector<std::string>& notes, const std::string& text) {
  for (const auto& note : notes)
    if (note.find(text) != std::string::npos) return true;
  return false;
}

/// Coordinates that no short decimal and no float holds, and extreme ones.
inline Soup awkward_soup() {
  Soup soup;
  soup.points = {{0.1, 1.0 / 3, -2e-308},
                 {1e300, -1e-300, 5e-324},
                 {123456789.12345679, 0.30000000000000004, -7},
                 {1, 2, 3},
                 {1, 2, 3},
                 {-0.5, 1e22, 1e-7}};
  // A degenerate triangle, a duplicate one, one on coinciding vertices.
  soup.triangles = {{0, 1, 2}, {2, 1, 0}, {0, 1, 2}, {3, 3, 4}, {5, 4, 3}};
  return soup;
}

inline void check_same_geometry(const Soup& a, const Soup& b) {
  REQUIRE(a.points.size() == b.points.size());
  CHECK(std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0);
  CHECK(a.triangles == b.triangles);
}

/// Writes, reads, writes again: the soup comes back and the second file equals the first byte for byte.
inline Soup round_trip(const Soup& soup, const std::string& name, bool ascii = false) {
  TemporaryFolder folder;
  Context context;
  write_mesh(folder / name, soup, {.ascii = ascii}, context);
  Soup back = read_mesh(folder / name, context);
  write_mesh(folder / ("again-" + name), back, {.ascii = ascii}, context);
  CHECK(file_bytes(folder / name) == file_bytes(folder / ("again-" + name)));
  return back;
}

/// Every cut of a file is refused: for formats that say how much must follow. `tail` bytes at the end may be missing.
inline void check_truncations(const std::string& bytes, const std::string& name, std::size_t tail) {
  for (std::size_t size = 0; size + tail < bytes.size(); ++size) {
    Context context;
    CAPTURE(size);
    CHECK_THROWS_AS(parse_mesh(bytes.substr(0, size), name, context), IoError);
  }
}

}  // namespace tri::test
