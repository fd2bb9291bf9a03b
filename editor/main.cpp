#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <vector>

#include "editor.hpp"

namespace {

/// GLFW, its window, and ImGui in it, for as long as this lives.
class Window {
 public:
  Window(int width, int height) {
    glfwSetErrorCallback([](int, const char* text) { std::fprintf(stderr, "tri-editor: %s\n", text); });
    if (!glfwInit()) throw std::runtime_error("there is no display to open a window on");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    window_ = glfwCreateWindow(width, height, "tri editor", nullptr, nullptr);
    if (!window_) {
      glfwTerminate();
      throw std::runtime_error("the display gives no window with OpenGL 3.3");
    }
    glfwMakeContextCurrent(window_);
    // Before ImGui's own, which calls this one: ImGui sees only keys that are still down when a frame begins.
    glfwSetWindowUserPointer(window_, this);
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int modifiers) {
      if (action == GLFW_RELEASE) return;
      static_cast<Window*>(glfwGetWindowUserPointer(window))
          ->keys_.push_back({key, (modifiers & GLFW_MOD_CONTROL) != 0, (modifiers & GLFW_MOD_SHIFT) != 0});
    });
    glfwSwapInterval(1);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // panels have fixed places; nothing is left behind in the folder
    ImGui::StyleColorsDark();
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330");
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  ~Window() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
  }

  bool closed() const { return glfwWindowShouldClose(window_); }

  /// @return the keys that went down since the last frame
  std::vector<editor::KeyPress> begin_frame() {
    keys_.clear();
    glfwWaitEventsTimeout(0.05);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    return keys_;
  }

  void end_frame() {
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    glViewport(0, 0, width, height);
    glClearColor(0.1F, 0.1F, 0.1F, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    glfwSwapBuffers(window_);
  }

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<editor::KeyPress> keys_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2) {
    std::fprintf(stderr, "usage: tri-editor [MESH]\n");
    return 2;
  }
  try {
    Window window(1280, 800);
    editor::Editor editor(tri::Registry::standard());
    if (argc == 2) editor.open(argv[1]);
    while (!window.closed() && !editor.wants_to_close()) {
      editor.frame(window.begin_frame());
      window.end_frame();
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tri-editor: %s\n", error.what());
    return 1;
  }
}
