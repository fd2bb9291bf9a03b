#include "meshops/context.hpp"

#include "meshops/error.hpp"

namespace tri {

void Context::checkpoint() const {
  if (cancelled()) throw Cancelled();
}

}  // namespace tri
