#include "player/window/shortcuts.h"

#include <array>
#include <cctype>

#include <SDL_keycode.h>
#include <imgui.h>

#include "player/camera_moves.h"
#include "player/window/session/view_names.h"

namespace splatlas {
namespace {

/// Rotation per press of an arrow key, in degrees.
constexpr double kKeyTurnDeg = 15;
constexpr double kKeyZoom = 1.25;

struct Help {
  const char* keys;
  const char* what;
};
constexpr std::array kHelp{
    Help{"Drag", "turn"},
    Help{"Shift, middle or right drag", "move"},
    Help{"Wheel, + and -", "zoom"},
    Help{"F", "fit: the selection fills the picture"},
    Help{"Double click", "fit to a structure, or to the selection"},
    Help{"Home", "first view"},
    Help{"Arrow keys", "turn by 15 degrees"},
    Help{"A  P  L  R  S  I", "anterior, posterior, left, right, superior, inferior"},
    Help{"Page down, Page up", "next scene of the atlas, scene before"},
    Help{"D", "toggle depth darkening"},
    Help{"Click", "choose a structure"},
    Help{"O", "isolate the chosen structure (only it)"},
    Help{"G", "ghost the others"},
    Help{"H, Delete", "hide the chosen structure"},
    Help{"Ctrl + Z, Ctrl + Y", "undo, redo"},
    Help{"/, Ctrl + F", "search a structure; Escape: back to the tree"},
    Help{"Ctrl + L", "type a selection"},
    Help{"Ctrl + S", "save the picture"},
    Help{"B", "black screen"},
    Help{"F1", "this list"},
    Help{"Ctrl + Q", "quit"},
};

void turn(Session& session, double azimuth_deg, double elevation_deg) {
  session.set_camera(turned(session.camera(), azimuth_deg, elevation_deg));
}

void zoom(Session& session, double factor) {
  session.set_camera(zoomed(session.camera(), factor));
}

bool camera_key(SDL_Keycode key, Session& session) {
  for (const NamedView view : kNamedViews) {
    if (key != std::tolower(title_of(view).front())) continue;
    session.turn_to(view);
    return true;
  }
  switch (key) {
    case SDLK_LEFT: turn(session, kKeyTurnDeg, 0); return true;
    case SDLK_RIGHT: turn(session, -kKeyTurnDeg, 0); return true;
    case SDLK_UP: turn(session, 0, -kKeyTurnDeg); return true;
    case SDLK_DOWN: turn(session, 0, kKeyTurnDeg); return true;
    case SDLK_PLUS:
    case SDLK_EQUALS:
    case SDLK_KP_PLUS: zoom(session, kKeyZoom); return true;
    case SDLK_MINUS:
    case SDLK_KP_MINUS: zoom(session, 1 / kKeyZoom); return true;
    case SDLK_HOME: session.reset_view(); return true;
    case SDLK_f: session.frame_selection(); return true;
    case SDLK_PAGEDOWN: session.show_next_scene(); return true;
    case SDLK_PAGEUP: session.show_scene_before(); return true;
    default: return false;
  }
}

bool structure_key(SDL_Keycode key, Session& session) {
  if (!session.current()) return false;
  const StructureIndex s = session.current()->structure;
  switch (key) {
    case SDLK_o: session.editor().isolate(s); return true;
    case SDLK_g: session.editor().ghost_others(s); return true;
    case SDLK_h:
    case SDLK_DELETE: session.editor().set_mode(s, DrawMode::kOff); return true;
    default: return false;
  }
}

}  // namespace

bool handle_key(const SDL_KeyboardEvent& key, Session& session, UiState& ui) {
  if ((key.keysym.mod & (KMOD_CTRL | KMOD_ALT | KMOD_GUI)) != 0) return false;
  const SDL_Keycode code = key.keysym.sym;
  switch (code) {
    case SDLK_SLASH: ui.focus_search = true; return true;
    case SDLK_b: ui.black_screen = true; return true;
    case SDLK_d:
      session.set_depth_cue(session.depth_cue() == DepthCue::kNone ? DepthCue::kEdges : DepthCue::kNone);
      return true;
    case SDLK_ESCAPE:
      session.rows().searching() ? session.rows().search("") : session.choose_nothing();
      return true;
    default: return camera_key(code, session) || structure_key(code, session);
  }
}

bool handle_global_key(const SDL_KeyboardEvent& key, Session& session, UiState& ui) {
  if (key.keysym.sym == SDLK_F1) {
    ui.show_help = !ui.show_help;
    return true;
  }
  if ((key.keysym.mod & KMOD_CTRL) == 0) return false;
  const bool shift = (key.keysym.mod & KMOD_SHIFT) != 0;
  switch (key.keysym.sym) {
    case SDLK_f: ui.focus_search = true; return true;
    case SDLK_l: ui.focus_text = true; return true;
    case SDLK_s: session.save_picture(); return true;
    case SDLK_q: ui.quit = true; return true;
    case SDLK_z: shift ? session.editor().redo() : session.editor().undo(); return true;
    case SDLK_y: session.editor().redo(); return true;
    default: return false;
  }
}

void help_overlay(UiState& ui) {
  if (!ui.show_help) return;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowFocus();
  constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize;
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ImGui::GetStyleColorVec4(ImGuiCol_PopupBg));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {24, 20});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  if (ImGui::Begin("help", nullptr, kFlags)) {
    for (const Help& help : kHelp) {
      ImGui::TextUnformatted(help.keys);
      ImGui::SameLine(ImGui::GetFontSize() * 15);
      ImGui::TextDisabled("%s", help.what);
    }
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
  const bool appeared = ImGui::IsMouseClicked(ImGuiMouseButton_Left) && !ImGui::IsAnyItemActive();
  if (appeared) ui.show_help = false;
}

}  // namespace splatlas
