// Main loop of the player window, and the entry point of its module.
#include <algorithm>
#include <exception>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "player/window/selection_bar.h"
#include "player/window/shortcuts.h"
#include "player/window/structure_panel.h"
#include "player/window/view_panel.h"
#include "player/window/window_host.h"
#include "player/window/window_module.h"

namespace splatlas {
namespace {

/// Frames to draw after an event, until ImGui has updated hover states and sizes.
constexpr int kFramesPerEvent = 3;
/// Frames until a text field has the keyboard focus. Later keys wait for it.
constexpr int kFramesToFocus = 4;
/// Redraw interval of a blinking text cursor.
constexpr int kBlinkMs = 300;
constexpr int kNoTimeout = -1;

class Window {
 public:
  Window(WindowHost& host, Session& session)
      : host_(host), session_(session), fonts_(apply_theme(host.ui_scale())), layout_(session.log()) {}

  void run() {
    int frames = kFramesPerEvent;
    bool announced = false;
    while (!ui_.quit) {
      if (frames > 0 || settle_ > 0) {
        frames = std::max(0, frames - 1);
        settle_ = std::max(0, settle_ - 1);
        draw_frame();
        if (!std::exchange(announced, true))
          session_.log().write("ready", {{"atlas", session_.atlas().name()}});
      }
      if (settle_ > 0) continue;
      const bool blinking = ImGui::GetIO().WantTextInput;
      const int timeout_ms = frames > 0 ? 0 : blinking ? kBlinkMs : kNoTimeout;
      if (host_.wait(timeout_ms, [this](const SDL_Event& event) { return take(event); })) {
        frames = kFramesPerEvent;
      }
      if (blinking) frames = std::max(frames, 1);
    }
    session_.log().write("closed", nlohmann::ordered_json::object());
  }

 private:
  /// Handles an event. Returns true if ImGui must not see it.
  bool take(const SDL_Event& event) {
    switch (event.type) {
      case SDL_QUIT: ui_.quit = true; return false;
      case SDL_KEYDOWN: return key_taken_ = press(event.key);
      case SDL_TEXTINPUT: return key_taken_;  // a shortcut's letter must not reach the field that it focuses
      case SDL_MOUSEBUTTONDOWN: return std::exchange(ui_.black_screen, false);
      default: return false;
    }
  }

  /// Handles a key press. Returns true for a shortcut.
  bool press(const SDL_KeyboardEvent& key) {
    if (std::exchange(ui_.black_screen, false)) return true;
    if (ui_.show_help && key.keysym.sym != SDLK_F1) {
      ui_.show_help = false;
      return true;
    }
    const bool shortcut = handle_global_key(key, session_, ui_) ||
                          (!ImGui::GetIO().WantTextInput && handle_key(key, session_, ui_));
    if (ui_.focus_search || ui_.focus_text) settle_ = kFramesToFocus;
    return shortcut;
  }

  void draw_frame() {
    host_.begin_frame();
    draw_panels();
    layout_.finish();
    session_.update();
    host_.end_frame();
  }

  void draw_panels() {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    constexpr ImGuiWindowFlags kFlags =
        ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
        ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse;
    if (ui_.black_screen) {
      ImGui::GetForegroundDrawList()->AddRectFilled({0, 0}, screen, IM_COL32_BLACK);
      return;
    }
    const float left = std::clamp(screen.x * 0.31f, ImGui::GetFontSize() * 22, ImGui::GetFontSize() * 30);
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({left, screen.y});
    if (ImGui::Begin("structures", nullptr, kFlags)) {
      structure_panel(session_, ui_, fonts_, layout_);
    }
    ImGui::End();
    ImGui::SetNextWindowPos({left, 0});
    ImGui::SetNextWindowSize({std::max(1.0f, screen.x - left), screen.y});
    if (ImGui::Begin("picture", nullptr, kFlags)) {
      view_panel_.draw(session_, ui_, fonts_, layout_,
                       SelectionBar::height() + ImGui::GetStyle().ItemSpacing.y);
      selection_bar_.draw(session_, ui_, fonts_, layout_);
    }
    ImGui::End();
    help_overlay(ui_);
  }

  WindowHost& host_;
  Session& session_;
  Fonts fonts_;
  LayoutLog layout_;
  ViewPanel view_panel_;
  SelectionBar selection_bar_;
  UiState ui_;
  bool key_taken_ = false;  // the latest key was a shortcut
  int settle_ = 0;          // frames to draw before the next event
};

/// Opens an atlas, shows it in a window, and returns when the user closes the window. Sleeps between events.
/// Errors of Atlas::open(), kFailed without a display, and kInvalidAtlas if pictures lacked damaged parts.
Result<void> run_window(const std::filesystem::path& path, const RendererOptions& renderer, double max_work) {
  auto atlas = Atlas::open(path, {.max_work = max_work});
  if (!atlas) return tl::unexpected(std::move(atlas).error());
  auto log = SessionLog::from_environment();
  if (!log) return tl::unexpected(std::move(log).error());
  const auto host = WindowHost::open(fmt::format("{} - Splatlas", path.filename().string()));
  if (!host) return tl::unexpected(host.error());
  Session session(
      *std::move(atlas), renderer, [&] { (*host)->wake(); }, *std::move(log));
  Window(**host, session).run();
  if (session.missing().empty()) return {};
  return fail(ErrorCode::kInvalidAtlas, fmt::format("{}: damaged; was shown without what is missing: {}",
                                                    path.string(), session.missing()));
}

}  // namespace
}  // namespace splatlas

extern "C" __attribute__((visibility("default"))) int splatlas_show_window(const char* path, unsigned threads,
                                                                           std::uint64_t max_memory_bytes,
                                                                           double max_work, char* error,
                                                                           std::size_t error_size) try {
  if (const auto result = splatlas::run_window(path, {threads, max_memory_bytes}, max_work); !result) {
    *fmt::format_to_n(error, error_size - 1, "{}", result.error().message).out = '\0';
    return static_cast<int>(result.error().code);
  }
  return splatlas::kWindowClosed;
} catch (const std::exception& exception) {
  *fmt::format_to_n(error, error_size - 1, "{}", exception.what()).out = '\0';
  return static_cast<int>(splatlas::ErrorCode::kFailed);
}

static_assert(std::is_same_v<decltype(&splatlas_show_window), splatlas::ShowWindow>);
