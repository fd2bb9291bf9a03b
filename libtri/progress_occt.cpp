#include "libtri/progress_occt.hpp"

namespace tri {

Standard_Boolean OcctProgress::UserBreak() {
  // As a checkpoint, but an exception would have to pass through OpenCASCADE.
  if (context_.on_checkpoint) context_.on_checkpoint();
  return context_.cancelled();
}

void OcctProgress::Show(const Message_ProgressScope&, const Standard_Boolean) {
  const double share = GetPosition();
  if (share < last_ + 0.005 && share < 1) return;
  last_ = share;
  context_.progress(step_, share);
}

}  // namespace tri
