#include "operator_panel.hpp"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <cmath>
#include <limits>
#include <tri/meshops/error.hpp>
#include <vector>

namespace editor {
namespace {

std::string label_of(const tri::OptionInfo& info) {
  return info.unit.empty() ? info.name : info.name + " (" + info.unit + ")";
}

bool edit_number(const tri::OptionInfo& info, double& value) {
  bool changed = false;
  if (info.infinite) {
    bool bounded = std::isfinite(value);
    if (ImGui::Checkbox("##bounded", &bounded)) {
      value = bounded ? (std::isfinite(info.minimum) ? info.minimum + 1 : 1) : std::numeric_limits<double>::infinity();
      changed = true;
    }
    ImGui::SameLine();
    if (!bounded) {
      ImGui::TextDisabled("no limit");
      ImGui::SameLine();
      ImGui::TextUnformatted(label_of(info).c_str());
      return changed;
    }
  }
  const bool bounded = std::isfinite(info.minimum) && std::isfinite(info.maximum) && !info.infinite;
  if (bounded) {
    changed |=
        ImGui::SliderScalar(label_of(info).c_str(), ImGuiDataType_Double, &value, &info.minimum, &info.maximum, "%.6g");
  } else {
    changed |= ImGui::InputDouble(label_of(info).c_str(), &value, 0, 0, "%.9g");
  }
  return changed;
}

/// A widget for one option. @return true if the user changed the value
bool edit(const tri::OptionInfo& info, tri::OptionValue& value) {
  switch (info.type) {
    case tri::OptionInfo::Type::boolean:
      return ImGui::Checkbox(info.name.c_str(), &std::get<bool>(value));
    case tri::OptionInfo::Type::integer:
      return ImGui::InputScalar(label_of(info).c_str(), ImGuiDataType_S64, &std::get<std::int64_t>(value));
    case tri::OptionInfo::Type::number:
      return edit_number(info, std::get<double>(value));
    case tri::OptionInfo::Type::choice: {
      auto& chosen = std::get<std::string>(value);
      bool changed = false;
      if (ImGui::BeginCombo(info.name.c_str(), chosen.c_str())) {
        for (const std::string& choice : info.choices) {
          if (ImGui::Selectable(choice.c_str(), choice == chosen)) {
            chosen = choice;
            changed = true;
          }
        }
        ImGui::EndCombo();
      }
      return changed;
    }
    case tri::OptionInfo::Type::text:
      return ImGui::InputText(info.name.c_str(), &std::get<std::string>(value));
    case tri::OptionInfo::Type::numbers: {
      auto& numbers = std::get<std::vector<double>>(value);
      bool changed = false;
      ImGui::TextUnformatted(label_of(info).c_str());
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        changed |= ImGui::InputDouble("##entry", &numbers[i], 0, 0, "%.9g");
        ImGui::PopID();
      }
      if (ImGui::SmallButton("+")) {
        numbers.push_back(numbers.empty() ? 0 : numbers.back());
        changed = true;
      }
      ImGui::SameLine();
      if (!numbers.empty() && ImGui::SmallButton("-")) {
        numbers.pop_back();
        changed = true;
      }
      return changed;
    }
  }
  return false;
}

/// As the library checks it: a value that is not allowed is refused with the library's own words.
void store(const tri::OptionSchema& schema, void* options, const tri::OptionSchema::Entry& entry,
           const tri::OptionValue& value) {
  const tri::OptionValue before = entry.get(options);
  entry.set(options, value);
  try {
    schema.validate(options);
  } catch (...) {
    entry.set(options, before);
    throw;
  }
}

}  // namespace

void* OperatorPanel::options_of(const tri::Operator& op) {
  auto& options = options_[&op];
  if (!options) options = op.schema().make();
  return options.get();
}

void OperatorPanel::draw_list() {
  if (focus_search_) ImGui::SetKeyboardFocusHere();
  focus_search_ = false;
  ImGui::SetNextItemWidth(-1);
  run_at_enter_ = ImGui::InputTextWithHint("##search", "search (Ctrl+F)", &search_,
                                           ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
  if (ImGui::BeginListBox("##operators", ImVec2(-1, 9 * ImGui::GetTextLineHeightWithSpacing()))) {
    bool first = true;
    for (const auto& op : registry_.operators()) {
      if (op->domain() == tri::Domain::points || op->result() != op->domain()) continue;  // what has no place on a mesh
      if (op->name().find(search_) == std::string::npos) continue;
      if (run_at_enter_ && first) chosen_ = op.get();
      first = false;
      if (ImGui::Selectable(op->name().c_str(), chosen_ == op.get())) chosen_ = op.get();
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", op->summary().c_str());
    }
    ImGui::EndListBox();
  }
}

void OperatorPanel::draw_form(const tri::OptionSchema& schema, void* options) {
  for (const auto& entry : schema.entries()) {
    ImGui::PushID(entry.info.name.c_str());
    tri::OptionValue value = entry.get(options);
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.45F);
    if (edit(entry.info, value)) {
      try {
        store(schema, options, entry, value);
        complaint_.clear();
      } catch (const tri::InvalidInput& refused) {
        complaint_ = refused.what();
      }
    }
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s\n%s", entry.info.help.c_str(), entry.info.allowed().c_str());
    ImGui::PopID();
  }
}

std::optional<OperatorRequest> OperatorPanel::draw(bool enabled, bool anything_selected) {
  draw_list();
  if (!chosen_) return std::nullopt;
  ImGui::Separator();
  ImGui::TextWrapped("%s", chosen_->summary().c_str());
  draw_form(chosen_->schema(), options_of(*chosen_));
  if (!complaint_.empty()) ImGui::TextWrapped("%s", complaint_.c_str());
  ImGui::BeginDisabled(!anything_selected);
  ImGui::Checkbox("selected faces only", &selection_only_);
  ImGui::EndDisabled();
  ImGui::BeginDisabled(!enabled);
  const bool run = ImGui::Button("Run (Enter)") || (enabled && run_at_enter_);
  ImGui::SameLine();
  const bool dry_run = ImGui::Button("Preview");
  ImGui::EndDisabled();
  if (!run && !dry_run) return std::nullopt;
  // A copy: what runs does not change when the user goes on in the form.
  const auto copy = chosen_->schema().make();
  for (const auto& entry : chosen_->schema().entries()) entry.set(copy.get(), entry.get(options_of(*chosen_)));
  return OperatorRequest{chosen_, copy, selection_only_ && anything_selected, dry_run && !run};
}

}  // namespace editor
