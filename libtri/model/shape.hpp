#pragma once

#include <memory>
#include <string>
#include <vector>

namespace tri {

/// A CAD shape as read from a file or built by `example_part`, without naming OpenCASCADE's types.
///
/// Cheap to copy: copies share the same immutable shape. Lengths are millimetres.
class Shape {
 public:
  struct Impl;  ///< defined in libtri/model/shape_occt.hpp, for the few files that wrap OpenCASCADE
  /// Holds nothing.
  Shape() = default;
  /// For the files that wrap OpenCASCADE.
  explicit Shape(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

  /// True if it holds nothing; only such a shape has no `impl`.
  bool empty() const noexcept { return impl_ == nullptr; }
  /// What OpenCASCADE works on; must not be empty.
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Sews loose faces into shells at `tolerance` mm where the shape holds neither a solid nor exactly one shell; any
/// other shape is returned as it is. Faces keep their surfaces and names; their order may change (CadFace::shape_face
/// follows it).
Shape sewn(const Shape& shape, double tolerance = 0.01);

}  // namespace tri
