#include "view/window.h"

#include <epoxy/gl.h>
// After epoxy's.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "view/layout.h"

namespace raio::core::view {
namespace {

const auto g_start = std::chrono::steady_clock::now();

std::string g_glfw_problem;
std::atomic<bool> g_open = false;

constexpr float kMinHeight = 800;
constexpr double kPartOfScreen = 0.85;  // of its sides, for a first window

void set_up_imgui(GLFWwindow* window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;              // no settings file
  io.ConfigDragClickToInputText = true;  // a click on a number edits it
  // It forwards all events to existing callbacks.
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

std::string no_window(std::string_view why) {
  return fmt::format("cannot open a window: {}{}; use raio render, which needs none", why,
                     g_glfw_problem.empty() ? "" : " (" + g_glfw_problem + ")");
}

}  // namespace

std::expected<std::unique_ptr<Window>, std::string> Window::open(std::array<int, 2> picture,
                                                                 std::array<int, 2> size,
                                                                 const Theme& look) {
  glfwSetErrorCallback([](int, const char* text) { g_glfw_problem = text; });
  if (!glfwInit()) return std::unexpected(no_window("no display"));
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  GLFWwindow* handle = glfwCreateWindow(640, 480, "Raio", nullptr, nullptr);
  if (!handle) {
    glfwTerminate();
    return std::unexpected(no_window("the display does not support OpenGL 3.3"));
  }
  std::unique_ptr<Window> window(new Window(handle));
  window->look_ = look;
  apply_look(look, window->text_scale_);
  int x = 0, y = 0, most_width = 1 << 14, most_height = 1 << 14;
  if (GLFWmonitor* monitor = glfwGetPrimaryMonitor())
    glfwGetMonitorWorkarea(monitor, &x, &y, &most_width, &most_height);
  const float unit = 1 / window->pixels_per_unit();
  glfwSetWindowSizeLimits(handle, 64, 64, GLFW_DONT_CARE, GLFW_DONT_CARE);
  const float em = em_of(look, window->text_scale_);
  if (picture[0] > 0) {
    const float bars = std::floor(kToolBarEms * em) + std::ceil(kStatusEms * em);
    size[0] = int(std::max(float(picture[0]) * unit + kPanelEms * em, kLeastWidthEms * em));
    size[1] = int(std::max(float(picture[1]) * unit + bars, kMinHeight * window->text_scale_));
  } else if (size[0] <= 0 || size[1] <= 0) {
    size = {int(most_width * kPartOfScreen), int(most_height * kPartOfScreen)};
  }
  glfwSetWindowSize(handle, std::min(size[0], most_width), std::min(size[1], most_height));
  glfwShowWindow(handle);
  return window;
}

Window::Window(GLFWwindow* window) : window_(window) {
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window, this);
  // On some systems window coordinates are pixels, on others they are scaled automatically.
  float scale_x = 1, scale_y = 1;
  glfwGetWindowContentScale(window, &scale_x, &scale_y);
  text_scale_ = std::clamp(scale_y / pixels_per_unit(), 0.5f, 8.0f);
  set_callbacks();
  set_up_imgui(window);
  g_open = true;
}

Window::~Window() {
  g_open = false;
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

Window& Window::of(GLFWwindow* window) {
  return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

void Window::tell(GLFWwindow* window, const Event& event) {
  if (const auto& listener = of(window).listener_) listener(event);
}

void Window::set_callbacks() {
  glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int mods) {
    tell(w, event::Refresh{});
    if (action != GLFW_PRESS) return;
    if (key >= 0) of(w).typed_.push_back(key);
    const bool is_never_text =
        key == GLFW_KEY_ESCAPE || (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F25);
    const event::KeyPressed pressed{key,
                                    {.shift = bool(mods & GLFW_MOD_SHIFT),
                                     .ctrl = bool(mods & GLFW_MOD_CONTROL),
                                     .alt = bool(mods & (GLFW_MOD_ALT | GLFW_MOD_SUPER))}};
    if (!is_never_text && of(w).has_clicked_)
      of(w).waiting_.push_back(pressed);
    else if (is_never_text || !is_typing())
      tell(w, pressed);
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int button, int action, int mods) {
    of(w).has_clicked_ |= button == GLFW_MOUSE_BUTTON_LEFT;
    if (action == GLFW_PRESS && button <= GLFW_MOUSE_BUTTON_MIDDLE)
      of(w).clicked_.push_back(button);
    tell(w, event::MouseButton{button, action == GLFW_PRESS, bool(mods & GLFW_MOD_SHIFT),
                               bool(mods & GLFW_MOD_CONTROL)});
  });
  glfwSetCursorPosCallback(
      window_, [](GLFWwindow* w, double x, double y) { tell(w, event::CursorMoved{x, y}); });
  glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double steps) {
    const bool ctrl = of(w).is_held(GLFW_KEY_LEFT_CONTROL) || of(w).is_held(GLFW_KEY_RIGHT_CONTROL);
    tell(w, event::Scrolled{steps, ctrl});
  });
  glfwSetDropCallback(window_, [](GLFWwindow* w, int count, const char** paths) {
    if (count > 0) tell(w, event::FileDropped{paths[0]});
  });
  glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned) { tell(w, event::Refresh{}); });
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* w) { tell(w, event::Refresh{}); });
  glfwSetFramebufferSizeCallback(window_,
                                 [](GLFWwindow* w, int, int) { tell(w, event::Refresh{}); });
  glfwSetWindowIconifyCallback(window_, [](GLFWwindow* w, int) { tell(w, event::Refresh{}); });
}

void Window::wait_events(double seconds) {
  if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
}
void Window::wake() {
  if (g_open) glfwPostEmptyEvent();
}

bool Window::should_close() const { return glfwWindowShouldClose(window_); }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
bool Window::is_held(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
bool Window::is_typing() {
  return ImGui::GetIO().WantTextInput || ImGui::GetCurrentContext()->WantTextInputNextFrame == 1;
}
bool Window::is_over_controls() { return ImGui::GetIO().WantCaptureMouse; }
bool Window::is_busy() { return ImGui::IsAnyItemActive(); }

bool Window::is_hidden() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) || width == 0 || height == 0;
}

double Window::width() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  return width;
}
double Window::height() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  return height;
}
float Window::pixels_per_unit() const {
  int pixels = 0, pixels_down = 0;
  glfwGetFramebufferSize(window_, &pixels, &pixels_down);
  return pixels > 0 && width() > 0 ? float(pixels / width()) : 1.0f;
}

void Window::set_look(const Theme& look) { look_ = look, has_new_look_ = true; }

bool Window::is_full_screen() const { return glfwGetWindowMonitor(window_) != nullptr; }
void Window::set_full_screen(bool on) {
  if (on == is_full_screen()) return;
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
  if (!mode) return;
  if (!on) return glfwSetWindowMonitor(window_, nullptr, left_, top_, last_width_, last_height_, 0);
  glfwGetWindowPos(window_, &left_, &top_);
  glfwGetWindowSize(window_, &last_width_, &last_height_);
  glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void Window::set_title(const std::string& title) {
  if (title == title_) return;
  title_ = title;
  glfwSetWindowTitle(window_, title.c_str());
}
void Window::set_clipboard(const std::string& text) {
  glfwSetClipboardString(window_, text.c_str());
}

void Window::begin_frame() {
  if (std::exchange(has_new_look_, false) || view::wants_letters()) {
    apply_look(look_, text_scale_);
    ImGui_ImplOpenGL3_DestroyFontsTexture();  // the next frame makes another
    ImGui_ImplOpenGL3_CreateFontsTexture();
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  // A key pressed and released between two frames counts as down for one.
  auto& down = ImGui::GetIO().KeysDown;
  for (const int key : typed_) down[key] = true;
  // So does a button. If it was down in the last frame, too, this is nevertheless another click.
  for (const int button : std::exchange(clicked_, {}))
    ImGui::GetIO().MouseDownDuration[button] = -1;
  ImGui::NewFrame();
  for (const int key : typed_) down[key] = is_held(key);
  typed_.clear();
}

void Window::end_frame() {
  ImGui::Render();
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  glViewport(0, 0, width, height);
  const ImVec4& mat = palette().mat;
  glClearColor(mat.x, mat.y, mat.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
  has_clicked_ = false;
  for (const event::KeyPressed& pressed : std::exchange(waiting_, {}))
    if (!is_typing()) tell(window_, pressed);
}

double Window::seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - g_start).count();
}

}  // namespace raio::core::view
