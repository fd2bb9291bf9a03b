#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "meshops/error.hpp"
#include "meshops/geometry.hpp"

namespace tri::python {

/// What a Python object holds: a mesh, a soup or points, which arrays may look into.
///
/// An array shares the ownership of what it looks into. Work that changes the object while there are such arrays works on a
/// copy, so that they stay valid and show what was there before. Python's lock is held in every member function.
template <class T>
class Held {
 public:
  explicit Held(std::shared_ptr<T> value) : value_(std::move(value)) {}

  /// For arrays. @throws InvalidInput while it is being changed
  std::shared_ptr<T> share() const {
    if (changing_) throw InvalidInput("this object is being changed by a call that has not ended");
    return value_;
  }

  /// Keeps the object from being changed as long as it lives; the value may be read without Python's lock.
  class Reading {
   public:
    explicit Reading(const Held& held) : held_(held), value_(held.share()) { ++held_.readers_; }
    Reading(const Reading&) = delete;
    ~Reading() { --held_.readers_; }
    const T& operator*() const { return *value_; }
    const T* operator->() const { return value_.get(); }

   private:
    const Held& held_;
    std::shared_ptr<T> value_;
  };

  /// Keeps everybody else from the object as long as it lives; the value may be changed without Python's lock.
  /// @throws InvalidInput if another call is reading or changing it
  class Changing {
   public:
    explicit Changing(Held& held) : held_(held) {
      if (held.changing_ || held.readers_ > 0) throw InvalidInput("this object is in use by a call that has not ended");
      if (held.value_.use_count() > 1) held.value_ = std::make_shared<T>(*held.value_);
      held.changing_ = true;
    }
    Changing(const Changing&) = delete;
    ~Changing() { held_.changing_ = false; }
    T& operator*() const { return *held_.value_; }
    T* operator->() const { return held_.value_.get(); }

   private:
    Held& held_;
  };

 private:
  std::shared_ptr<T> value_;
  mutable int readers_ = 0;
  bool changing_ = false;
};

using HeldPoints = Held<PointSet>;
using HeldSoup = Held<Soup>;

/// Also knows what was done to build it.
struct HeldMesh : Held<Mesh> {
  using Held<Mesh>::Held;
  nlohmann::ordered_json build_report;  ///< null if it was not built from triangles
};

}  // namespace tri::python
