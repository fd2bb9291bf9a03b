#include "meshops/operators/compact.hpp"
#include "meshops/registry.hpp"

namespace tri {

void register_operators(Registry& registry) {
  registry.add("compact", compact, "Drops elements marked as deleted; the others keep their order",
               {.keeps_handles = false});
}

}  // namespace tri
