#include "editor.hpp"

#include <imgui.h>
#include <imgui_stdlib.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <tri/meshops/error.hpp>

#include "selection.hpp"

namespace editor {
namespace {

constexpr float side_width = 330, log_height = 150;
constexpr ImGuiWindowFlags fixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                                   ImGuiWindowFlags_NoBringToFrontOnFocus;

std::string numbers_of(const tri::Report& report) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(report.vertices_added, "vertices added");
  add(report.vertices_removed, "vertices removed");
  add(report.vertices_moved, "vertices moved");
  add(report.faces_added, "faces added");
  add(report.faces_removed, "faces removed");
  add(report.faces_reversed, "faces reversed");
  add(report.edges_flipped, "edges flipped");
  return text.empty() ? "nothing changed" : text;
}

}  // namespace

Editor::Editor(const tri::Registry& registry) : panel_(registry) {}

void Editor::open(const std::string& path) {
  if (job_.running()) return;
  refit_ = true;
  job_.start("open " + path, [this, path](tri::Context& context) {
    outcome_ = document_.open(path, context);
    outcome_.insert(outcome_.begin(), "opened " + path + ": " + std::to_string(document_.mesh().n_vertices()) +
                                          " vertices, " + std::to_string(document_.mesh().n_faces()) + " faces");
  });
}

void Editor::save(const std::string& path) {
  if (job_.running()) return;
  job_.start("save " + path, [this, path](tri::Context& context) {
    outcome_ = document_.save(path, context);
    outcome_.insert(outcome_.begin(), "saved " + path);
  });
}

void Editor::run(const OperatorRequest& request) {
  job_.start(request.op->name(), [this, request](tri::Context& context) {
    const tri::Report report = document_.run(request, context);
    outcome_ = {request.op->name() + (request.dry_run ? " would do: " : ": ") + numbers_of(report)};
    for (const auto& [reason, count] : report.skipped)
      outcome_.push_back("  left alone: " + std::to_string(count) + ", " + reason);
    for (const std::string& note : report.notes) outcome_.push_back("  " + note);
  });
}

void Editor::undo() {
  if (!document_.can_undo()) return;
  document_.undo();
  say("undone: " + document_.history()[document_.steps_done()].title);
}

void Editor::redo() {
  if (!document_.can_redo()) return;
  document_.redo();
  say("redone: " + document_.history()[document_.steps_done() - 1].title);
}

void Editor::paint_selection(int brush) {
  EditorMesh& mesh = document_.mesh();
  OpenMesh::FPropHandleT<int> property;
  if (!mesh.get_property_handle(property, brush_property)) return;
  for (std::size_t i = 0; i < mesh.n_faces(); ++i) {
    const OpenMesh::FaceHandle f(static_cast<int>(i));
    if (!mesh.status(f).deleted() && mesh.status(f).selected()) mesh.property(property, f) = brush;
  }
  renderer_.send_marks(mesh);
}

void Editor::say(const std::string& line) {
  log_.push_back(line);
  if (log_.size() > 500) log_.pop_front();
  log_moved_ = true;
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void Editor::finish_job() {
  if (!job_.running() || !job_.done()) return;
  try {
    job_.finish();
    for (const std::string& line : outcome_) say(line);
  } catch (const tri::Cancelled&) {
    say(job_.name() + ": cancelled, the mesh is as it was");
  } catch (const std::exception& error) {
    say(job_.name() + " failed: " + error.what());
  }
  outcome_.clear();
}

void Editor::send_changes() {
  if (const auto stale = document_.take_stale_faces()) {
    if (!stale->empty()) renderer_.send_faces(document_.mesh(), *stale);
  } else {
    renderer_.send_all(document_.mesh());
  }
  if (refit_) frame_mesh();
  refit_ = false;
}

void Editor::frame_mesh() {
  const EditorMesh& mesh = document_.mesh();
  if (mesh.n_vertices() == 0) return;
  OpenMesh::Vec3f low = mesh.point(OpenMesh::VertexHandle(0)), high = low;
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    const OpenMesh::VertexHandle v(static_cast<int>(i));
    if (mesh.status(v).deleted()) continue;
    low.minimize(mesh.point(v));
    high.maximize(mesh.point(v));
  }
  const OpenMesh::Vec3f center = (low + high) * 0.5F;
  camera_.frame({center[0], center[1], center[2]}, (high - low).norm() / 2);
}

void Editor::frame(const std::vector<KeyPress>& keys) {
  finish_job();
  if (!job_.running()) send_changes();
  handle_shortcuts(keys);
  draw_menu();
  draw_viewport();
  draw_side();
  draw_log();
  draw_path_dialog();
  draw_progress();
}

void Editor::handle_shortcuts(const std::vector<KeyPress>& keys) {
  for (const KeyPress& press : keys) {
    if (job_.running()) {
      if (press.key == GLFW_KEY_ESCAPE) job_.cancel();
    } else if (!asking_) {
      handle_shortcut(press);
    }
  }
}

void Editor::handle_shortcut(const KeyPress& press) {
  EditorMesh& mesh = document_.mesh();
  if (press.key == GLFW_KEY_HOME) frame_mesh();
  if (!press.ctrl) return;
  // In a text field these edit the text.
  const bool of_text = press.key == 'A' || press.key == 'Z' || press.key == 'Y';
  if (of_text && ImGui::GetIO().WantTextInput) return;
  switch (press.key) {
    case 'O':
      asking_ = PathAction::open;
      break;
    case 'S':
      if (press.shift || document_.path().empty()) {
        asking_ = PathAction::save;
      } else {
        save(document_.path());
      }
      break;
    case 'F':
      panel_.focus_search();
      break;
    case 'Q':
      close_ = true;
      break;
    case 'Z':
      press.shift ? redo() : undo();
      break;
    case 'Y':
      redo();
      break;
    case 'A':
      select_all(mesh);
      report_selection();
      break;
    case 'D':
      select_none(mesh);
      report_selection();
      break;
    case 'I':
      invert_selection(mesh);
      report_selection();
      break;
    case 'G':
      grow_selection(mesh);
      report_selection();
      break;
    case 'L':
      select_components(mesh);
      report_selection();
      break;
    default:
      break;
  }
}

void Editor::report_selection() {
  renderer_.send_marks(document_.mesh());
  say("selected: " + std::to_string(count_selected(document_.mesh())) + " faces");
}

void Editor::draw_menu() {
  if (!ImGui::BeginMainMenuBar()) return;
  const bool idle = !job_.running();
  EditorMesh& mesh = document_.mesh();
  if (ImGui::BeginMenu("File", idle)) {
    if (ImGui::MenuItem("Open...", "Ctrl+O")) asking_ = PathAction::open;
    if (ImGui::MenuItem("Save", "Ctrl+S", false, !document_.path().empty())) save(document_.path());
    if (ImGui::MenuItem("Save as...", "Ctrl+Shift+S")) asking_ = PathAction::save;
    if (ImGui::MenuItem("Quit", "Ctrl+Q")) close_ = true;
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Edit", idle)) {
    if (ImGui::MenuItem("Undo", "Ctrl+Z", false, document_.can_undo())) undo();
    if (ImGui::MenuItem("Redo", "Ctrl+Y", false, document_.can_redo())) redo();
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Select", idle)) {
    bool changed = true;
    if (ImGui::MenuItem("All", "Ctrl+A")) {
      select_all(mesh);
    } else if (ImGui::MenuItem("None", "Ctrl+D")) {
      select_none(mesh);
    } else if (ImGui::MenuItem("Invert", "Ctrl+I")) {
      invert_selection(mesh);
    } else if (ImGui::MenuItem("Grow", "Ctrl+G")) {
      grow_selection(mesh);
    } else if (ImGui::MenuItem("Connected", "Ctrl+L")) {
      select_components(mesh);
    } else {
      changed = false;
    }
    if (changed) report_selection();
    ImGui::Separator();
    for (int brush = 0; brush < 4; ++brush)
      if (ImGui::MenuItem(brush == 0 ? "Unpaint" : ("Paint with brush " + std::to_string(brush)).c_str()))
        paint_selection(brush);
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("View")) {
    ImGui::MenuItem("Edges", nullptr, &style_.edges);
    ImGui::MenuItem("Boundary", nullptr, &style_.boundary);
    if (ImGui::MenuItem("Whole mesh", "Home")) frame_mesh();
    ImGui::EndMenu();
  }
  ImGui::EndMainMenuBar();
}

void Editor::draw_viewport() {
  const ImGuiViewport& window = *ImGui::GetMainViewport();
  ImGui::SetNextWindowPos(window.WorkPos);
  ImGui::SetNextWindowSize(ImVec2(window.WorkSize.x - side_width, window.WorkSize.y - log_height));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::Begin("Viewport", nullptr,
               fixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoNav);
  const ImVec2 corner = ImGui::GetCursorScreenPos(), size = ImGui::GetContentRegionAvail();
  viewport_ = {corner.x, corner.y, std::max(1, static_cast<int>(size.x)), std::max(1, static_cast<int>(size.y)), false};
  const unsigned picture = renderer_.draw(camera_, viewport_.width, viewport_.height, style_);
  ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture)), size, ImVec2(0, 1), ImVec2(1, 0));
  viewport_.hovered = ImGui::IsItemHovered();
  handle_mouse();
  ImGui::End();
  ImGui::PopStyleVar();
}

void Editor::handle_mouse() {
  const ImGuiIO& io = ImGui::GetIO();
  if (viewport_.hovered) {
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !job_.running())
      box_drag_ = {io.MousePos.x, io.MousePos.y, true};
    if (io.MouseWheel != 0) camera_.approach(io.MouseWheel);
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Right, 0)) camera_.turn(io.MouseDelta.x, io.MouseDelta.y);
    if (ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 0))
      camera_.move(io.MouseDelta.x, io.MouseDelta.y, viewport_.height);
  }
  if (!box_drag_.active) return;
  const ImVec2 low(std::min(box_drag_.x, io.MousePos.x), std::min(box_drag_.y, io.MousePos.y));
  const ImVec2 high(std::max(box_drag_.x, io.MousePos.x), std::max(box_drag_.y, io.MousePos.y));
  ImGui::GetWindowDrawList()->AddRect(low, high, IM_COL32(255, 160, 40, 255));
  if (!ImGui::IsMouseReleased(ImGuiMouseButton_Left)) return;
  box_drag_.active = false;
  if (job_.running()) return;
  const PixelBox box{static_cast<int>(low.x - viewport_.x), static_cast<int>(low.y - viewport_.y),
                     static_cast<int>(high.x - low.x) + 1, static_cast<int>(high.y - low.y) + 1};
  const auto faces = renderer_.faces_in(box);
  select_faces(document_.mesh(), faces,
               io.KeyShift  ? SelectMode::add
               : io.KeyCtrl ? SelectMode::remove
                            : SelectMode::replace);
  report_selection();
}

void Editor::draw_side() {
  const ImGuiViewport& window = *ImGui::GetMainViewport();
  ImGui::SetNextWindowPos(ImVec2(window.WorkPos.x + window.WorkSize.x - side_width, window.WorkPos.y));
  ImGui::SetNextWindowSize(ImVec2(side_width, window.WorkSize.y));
  ImGui::Begin("Operators", nullptr, fixed);
  const EditorMesh& mesh = document_.mesh();
  // While a job runs the mesh is its own; counting selected faces would read what it writes.
  const std::size_t selected = job_.running() ? 0 : count_selected(mesh);
  if (job_.running()) {
    ImGui::TextDisabled("...");
  } else {
    ImGui::Text("%zu vertices, %zu faces, %zu selected%s", mesh.n_vertices(), mesh.n_faces(), selected,
                document_.modified() ? " *" : "");
  }
  const auto request = panel_.draw(!job_.running() && !asking_, selected > 0);
  if (ImGui::CollapsingHeader("History", ImGuiTreeNodeFlags_DefaultOpen) && !job_.running()) {
    for (std::size_t i = 0; i < document_.history().size(); ++i) {
      const bool done = i < document_.steps_done();
      ImGui::TextColored(done ? ImVec4(1, 1, 1, 1) : ImVec4(0.5F, 0.5F, 0.5F, 1), "%zu  %s", i + 1,
                         document_.history()[i].title.c_str());
    }
  }
  ImGui::End();
  if (request) run(*request);
}

void Editor::draw_log() {
  const ImGuiViewport& window = *ImGui::GetMainViewport();
  ImGui::SetNextWindowPos(ImVec2(window.WorkPos.x, window.WorkPos.y + window.WorkSize.y - log_height));
  ImGui::SetNextWindowSize(ImVec2(window.WorkSize.x - side_width, log_height));
  ImGui::Begin("Log", nullptr, fixed);
  for (const std::string& line : log_) ImGui::TextWrapped("%s", line.c_str());
  if (log_moved_) ImGui::SetScrollHereY(1);
  log_moved_ = false;
  ImGui::End();
}

void Editor::draw_path_dialog() {
  if (!asking_) return;
  const char* title = *asking_ == PathAction::open ? "Open a mesh" : "Save the mesh";
  if (!ImGui::IsPopupOpen(title)) {
    asked_path_ = document_.path();
    ImGui::OpenPopup(title);
  }
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(500);
  const bool entered = ImGui::InputText("##path", &asked_path_,
                                        ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
  const bool ok = ImGui::Button("OK") || entered;
  ImGui::SameLine();
  const bool dismissed = ImGui::Button("Cancel") || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false);
  if (ok || dismissed) {
    const PathAction action = *asking_;
    asking_.reset();
    ImGui::CloseCurrentPopup();
    if (ok && action == PathAction::open) open(asked_path_);
    if (ok && action == PathAction::save) save(asked_path_);
  }
  ImGui::EndPopup();
}

void Editor::draw_progress() {
  if (!job_.running()) return;
  const Job::Progress progress = job_.progress();
  const ImGuiViewport& window = *ImGui::GetMainViewport();
  ImGui::SetNextWindowPos(window.GetCenter(), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  ImGui::Begin("Working", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
  ImGui::Text("%s", progress.step.c_str());
  ImGui::ProgressBar(progress.share, ImVec2(300, 0));
  if (ImGui::Button("Cancel (Esc)")) job_.cancel();
  ImGui::End();
}

}  // namespace editor
