#pragma once

// Included only by the source files that wrap OpenCASCADE.
#include <Message_ProgressIndicator.hxx>
#include <string>

#include "meshops/context.hpp"

namespace tri {

/// Hands OpenCASCADE's progress to a context and the context's cancel to OpenCASCADE, which then returns early with a
/// result of no use: `context.checkpoint()` must follow.
class OcctProgress : public Message_ProgressIndicator {
 public:
  /// @param context must outlive the indicator
  OcctProgress(const Context& context, std::string step) : context_(context), step_(std::move(step)) {}
  Standard_Boolean UserBreak() override;

 protected:
  void Show(const Message_ProgressScope&, const Standard_Boolean) override;

 private:
  const Context& context_;
  std::string step_;
  double last_ = 0;
};

}  // namespace tri
