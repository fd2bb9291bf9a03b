#include "invariants.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  tri::fuzz::read_as_mesh({reinterpret_cast<const char*>(data), size}, "input.gltf");
  return 0;
}
