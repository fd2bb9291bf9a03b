#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>
#include <vector>

#include "meshops/editing/change_segment.hpp"
#include "meshops/error.hpp"
#include "meshops/geometry.hpp"

namespace tri::python {

/// What a Python object holds: a mesh, a soup or points, which arrays may look into.
///
/// An array shares the ownership of what it looks into. Work that changes the object while there are such arrays leaves
/// them what they look into and works on a copy, so that they stay valid and show what was there before. A mesh stays
/// where it is in memory, as recorded changes want it: only its properties are copied. Python's lock is held in every
/// member function.
template <class T>
class Held {
 public:
  explicit Held(std::shared_ptr<T> value) { adopt(std::move(value)); }

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
      if (held.value_.use_count() > 1) held.part_from_arrays();
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
  /// What arrays own: the value, and properties that have been taken out of it since.
  struct Box {
    std::shared_ptr<T> value;
    std::vector<std::unique_ptr<OpenMesh::BaseProperty>> parted;
  };

  void adopt(std::shared_ptr<T> value) {
    auto box = std::make_shared<Box>();
    box->value = std::move(value);
    box_ = box.get();
    value_ = std::shared_ptr<T>(std::move(box), box_->value.get());
  }

  void part_from_arrays() {
    if constexpr (std::is_same_v<T, Mesh>) {
      Box* const old = box_;
      const std::shared_ptr<T> kept = value_;  // keeps the old box as well
      for (const ElementKind kind : {ElementKind::vertex, ElementKind::face})
        for (OpenMesh::BaseProperty*& slot : property_slots(*kept, kind))
          if (slot) {
            OpenMesh::BaseProperty* const copy = slot->clone();
            old->parted.emplace_back(std::exchange(slot, copy));
          }
      adopt(old->value);
    } else {
      adopt(std::make_shared<T>(*value_));
    }
  }

  std::shared_ptr<T> value_;  ///< shares the ownership of the box
  Box* box_ = nullptr;        ///< of `value_`
  mutable int readers_ = 0;
  bool changing_ = false;
};

using HeldPoints = Held<PointSet>;
using HeldSoup = Held<Soup>;

class Change;

/// Also knows what was done to build it, and who records what is done to it.
struct HeldMesh : Held<Mesh> {
  using Held<Mesh>::Held;
  nlohmann::ordered_json build_report;  ///< null if it was not built from triangles
  std::weak_ptr<Change> recording;
};

}  // namespace tri::python
