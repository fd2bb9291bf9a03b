#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tri/meshops/registry.hpp>

namespace editor {

/// What the user asked for in the panel.
struct OperatorRequest {
  const tri::Operator* op = nullptr;
  std::shared_ptr<void> options;  ///< of the operator's own type
  bool selection_only = false;
  bool dry_run = false;
};

/// A list of all operators of a registry, and a form for the options of the chosen one.
///
/// Nothing here knows any operator: the form is drawn from its schema. An operator that a plug-in brings looks like the
/// others.
class OperatorPanel {
 public:
  /// @param registry outlives the panel
  explicit OperatorPanel(const tri::Registry& registry) : registry_(registry) {}

  /// Draws into the current ImGui window. @param enabled false while something runs
  /// @return what to run, if a button was pressed
  std::optional<OperatorRequest> draw(bool enabled, bool anything_selected);

  /// Moves the keyboard to the search field at the next `draw`.
  void focus_search() { focus_search_ = true; }

 private:
  void draw_list();
  void draw_form(const tri::OptionSchema& schema, void* options);
  void* options_of(const tri::Operator& op);

  const tri::Registry& registry_;
  std::string search_;
  const tri::Operator* chosen_ = nullptr;
  std::map<const tri::Operator*, std::shared_ptr<void>> options_;  ///< as last set, for each operator
  std::string complaint_;                                          ///< why the last value was refused
  bool selection_only_ = true;                                     ///< as long as anything is selected
  bool focus_search_ = false;
  bool run_at_enter_ = false;
};

}  // namespace editor
