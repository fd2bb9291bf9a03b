#include "invariants.hpp"
#include "io/mesh_formats/zip_archive.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  tri::fuzz::read_as_mesh(bytes, "input.3mf");
  // No change at random keeps a checksum right: behind it nothing would ever be tried.
  tri::fuzz::read_as_mesh(tri::io_detail::zip_of({{"3D/3dmodel.model", std::string(bytes)}}, "input.3mf"), "input.3mf");
  return 0;
}
