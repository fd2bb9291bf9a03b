#include "meshops/context.hpp"

#include "meshops/error.hpp"

namespace tri {

void Context::checkpoint() const {
  if (on_checkpoint) on_checkpoint();
  if (cancelled()) throw Cancelled();
}

}  // namespace tri
