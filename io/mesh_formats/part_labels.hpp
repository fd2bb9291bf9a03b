#pragma once

#include <map>
#include <string>
#include <vector>

#include "meshops/soup.hpp"

namespace tri::io_detail {

/// Gathers the face scalar and the labels of a name ("object", "material") while triangles are appended to a soup.
class PartLabels {
 public:
  explicit PartLabels(std::string scalar) : scalar_(std::move(scalar)) {}

  /// The label of this name, new or old.
  double label(const std::string& name) {
    const auto [found, is_new] = numbers_.try_emplace(name, names_.size());
    if (is_new) names_.push_back(name);
    return static_cast<double>(found->second);
  }
  /// A label of its own: "NAME", or "NAME (2)" and so on where that is taken.
  double own_label(const std::string& name) {
    std::string free = name;
    for (std::size_t k = ++copies_[name]; numbers_.contains(free); ++k) free = name + " (" + std::to_string(k) + ")";
    return label(free);
  }

  /// The triangles from `values().size()` to `end` get this label, -1 for none.
  void fill(std::size_t end, double label) { values_.resize(end, label); }
  const std::vector<std::string>& names() const { return names_; }

  /// Puts scalar and labels into the soup, all of whose triangles are filled; nothing without names.
  void finish(Soup& soup) && {
    if (names_.empty()) return;
    soup.face_scalars[scalar_] = std::move(values_);
    soup.face_labels[scalar_] = std::move(names_);
  }

 private:
  std::string scalar_;
  std::map<std::string, std::size_t> numbers_, copies_;
  std::vector<std::string> names_;
  std::vector<double> values_;
};

}  // namespace tri::io_detail
