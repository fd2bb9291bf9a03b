#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <tri/meshops/registry.hpp>
#include <vector>

#include "camera.hpp"
#include "document.hpp"
#include "job.hpp"
#include "mesh_renderer.hpp"
#include "operator_panel.hpp"

namespace editor {

/// A key that went down, as GLFW numbers them: letters are their capitals.
struct KeyPress {
  int key = 0;
  bool ctrl = false, shift = false;
};

/// The window's contents: viewport, panels, shortcuts. One object per window.
class Editor {
 public:
  /// @param registry outlives the editor. An OpenGL context is current.
  explicit Editor(const tri::Registry& registry);

  /// Reads a mesh on the job's thread.
  void open(const std::string& path);
  /// Draws one frame into the current ImGui frame, and does what the user asks for.
  /// @param keys  that went down since the last frame, also those that are up again
  void frame(const std::vector<KeyPress>& keys);
  /// True while a job runs, so that frames have to be drawn without input.
  bool busy() const { return job_.running(); }
  bool wants_to_close() const { return close_; }

 private:
  void draw_menu();
  void draw_viewport();
  void draw_side();
  void draw_log();
  void draw_progress();
  void draw_path_dialog();
  void handle_shortcuts(const std::vector<KeyPress>& keys);
  void handle_shortcut(const KeyPress& press);
  void report_selection();
  void handle_mouse();
  void finish_job();
  void send_changes();
  void frame_mesh();

  void save(const std::string& path);
  void run(const OperatorRequest& request);
  void undo();
  void redo();
  void paint_selection(int brush);
  /// A line for the user, and on standard output for whoever drives the editor.
  void say(const std::string& line);

  Document document_;
  Job job_;
  MeshRenderer renderer_;
  Camera camera_;
  OperatorPanel panel_;
  MeshRenderer::Style style_;
  std::deque<std::string> log_;
  std::vector<std::string> outcome_;  ///< written by the job, read when it is done
  bool refit_ = false;                ///< frame the mesh once the job is done
  bool close_ = false;
  bool log_moved_ = false;

  struct Viewport {
    float x = 0, y = 0;
    int width = 1, height = 1;
    bool hovered = false;
  } viewport_;
  struct Drag {
    float x = 0, y = 0;
    bool active = false;
  } box_drag_;

  enum class PathAction { open, save };
  std::optional<PathAction> asking_;
  std::string asked_path_;
};

}  // namespace editor
