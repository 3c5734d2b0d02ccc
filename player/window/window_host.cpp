#include "player/window/window_host.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <string_view>

#include <SDL_opengl.h>
#include <backends/imgui_impl_opengl2.h>
#include <backends/imgui_impl_sdl.h>
#include <fmt/format.h>
#include <imgui.h>

namespace splatlas {
namespace {

constexpr int kWidth = 1360, kHeight = 860;
constexpr int kMinWidth = 640, kMinHeight = 420;
constexpr float kReferenceDotsPerInch = 96;

tl::unexpected<Error> cannot_open(std::string_view reason) {
  return fail(ErrorCode::kFailed,
              fmt::format("cannot open a window: {}; use 'splatlas-player render'", reason));
}

/// Restricts SDL to drivers of window systems unless the user names a driver. Otherwise SDL falls back to
/// off-screen drawing, or takes over the console of a server.
void choose_video_driver() {
  if (SDL_GetHint(SDL_HINT_VIDEODRIVER) != nullptr) return;
  SDL_SetHint(SDL_HINT_VIDEODRIVER, SDL_getenv("WAYLAND_DISPLAY") != nullptr ? "x11,wayland" : "x11");
}

tl::unexpected<Error> no_display() {
  const char* display = SDL_getenv("DISPLAY");
  if (display == nullptr || *display == '\0') return cannot_open("there is no display (DISPLAY is not set)");
  return cannot_open(fmt::format("the display {} does not answer", display));
}

/// Scale of the user interface, rounded down to quarters for regular font sizes.
float measure_scale(int display) {
  float dots_per_inch = 0;
  if (SDL_GetDisplayDPI(display, nullptr, &dots_per_inch, nullptr) != 0) return 1;
  const float scale = std::floor(4 * dots_per_inch / kReferenceDotsPerInch) / 4;
  return std::isfinite(scale) ? std::clamp(scale, 1.0f, 3.0f) : 1;
}

bool is_button(Uint32 type) {
  return type == SDL_MOUSEBUTTONDOWN || type == SDL_MOUSEBUTTONUP;
}

/// True if ImGui needs a frame between this event and the next one: it reads states, not events.
bool wants_a_frame(const SDL_Event& event) {
  if (event.type == SDL_KEYDOWN || event.type == SDL_KEYUP || is_button(event.type)) return true;
  SDL_Event next;
  return event.type == SDL_MOUSEMOTION &&
         SDL_PeepEvents(&next, 1, SDL_PEEKEVENT, SDL_FIRSTEVENT, SDL_LASTEVENT) == 1 && is_button(next.type);
}

}  // namespace

Result<std::unique_ptr<WindowHost>> WindowHost::open(const std::string& title) {
  std::unique_ptr<WindowHost> host(new WindowHost);
  if (auto started = host->start(title); !started) return tl::unexpected(std::move(started).error());
  return host;
}

Result<void> WindowHost::start(const std::string& title) {
  choose_video_driver();
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return no_display();
  sdl_ = true;
  SDL_GL_SetAttribute(SDL_GL_DOUBLEBUFFER, 1);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 2);
  SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 1);
  ui_scale_ = measure_scale(0);
  SDL_Rect room{0, 0, kWidth, kHeight};
  SDL_GetDisplayUsableBounds(0, &room);
  const auto scaled = [this](int units) { return static_cast<int>(static_cast<float>(units) * ui_scale_); };
  window_ = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                             std::min(scaled(kWidth), room.w), std::min(scaled(kHeight), room.h),
                             SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE | SDL_WINDOW_ALLOW_HIGHDPI);
  if (window_ == nullptr) return cannot_open(SDL_GetError());
  SDL_SetWindowMinimumSize(window_, kMinWidth, kMinHeight);
  context_ = SDL_GL_CreateContext(window_);
  if (context_ == nullptr) return cannot_open(SDL_GetError());
  SDL_GL_SetSwapInterval(1);  // optional: drawing is event-driven
  wake_event_ = SDL_RegisterEvents(1);

  ImGui::CreateContext();
  imgui_ = true;
  ImGui::GetIO().IniFilename = nullptr;  // no settings file
  imgui_sdl_ = ImGui_ImplSDL2_InitForOpenGL(window_, context_);
  imgui_gl_ = imgui_sdl_ && ImGui_ImplOpenGL2_Init();
  if (!imgui_gl_) return fail(ErrorCode::kFailed, "cannot open a window: Dear ImGui does not start");
  return {};
}

WindowHost::~WindowHost() {
  if (imgui_gl_) ImGui_ImplOpenGL2_Shutdown();
  if (imgui_sdl_) ImGui_ImplSDL2_Shutdown();
  if (imgui_) ImGui::DestroyContext();
  if (context_ != nullptr) SDL_GL_DeleteContext(context_);
  if (window_ != nullptr) SDL_DestroyWindow(window_);
  if (sdl_) SDL_Quit();
}

bool WindowHost::wait(int timeout_ms, const std::function<bool(const SDL_Event&)>& take) {
  SDL_Event event;
  const int got = timeout_ms < 0 ? SDL_WaitEvent(&event) : SDL_WaitEventTimeout(&event, timeout_ms);
  if (got == 0) return false;
  do {
    follow_pointer(event);
    if (!take(event)) ImGui_ImplSDL2_ProcessEvent(&event);
  } while (!wants_a_frame(event) && SDL_PollEvent(&event) != 0);
  return true;
}

void WindowHost::follow_pointer(const SDL_Event& event) {
  switch (event.type) {
    case SDL_MOUSEMOTION: pointer_ = {event.motion.x, event.motion.y}; break;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP: pointer_ = {event.button.x, event.button.y}; break;
    case SDL_WINDOWEVENT:
      // A pressed button captures the pointer.
      if (event.window.event == SDL_WINDOWEVENT_LEAVE && SDL_GetMouseState(nullptr, nullptr) == 0)
        pointer_.reset();
      break;
    default: break;
  }
}

void WindowHost::wake() const {
  SDL_Event event{};
  event.type = wake_event_;
  SDL_PushEvent(&event);
}

void WindowHost::begin_frame() {
  ImGui_ImplOpenGL2_NewFrame();
  ImGui_ImplSDL2_NewFrame();
  // Replace the position from ImGui's backend, which queries the display server. It is ahead of the events,
  // and lags behind a pointer that another program moves (remote desktop).
  ImGui::GetIO().MousePos = pointer_
                                ? ImVec2(static_cast<float>(pointer_->x), static_cast<float>(pointer_->y))
                                : ImVec2(-FLT_MAX, -FLT_MAX);
  ImGui::NewFrame();
}

void WindowHost::end_frame() {
  ImGui::Render();
  const ImGuiIO& io = ImGui::GetIO();
  glViewport(0, 0, static_cast<int>(io.DisplaySize.x * io.DisplayFramebufferScale.x),
             static_cast<int>(io.DisplaySize.y * io.DisplayFramebufferScale.y));
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL2_RenderDrawData(ImGui::GetDrawData());
  SDL_GL_SwapWindow(window_);
}

}  // namespace splatlas
