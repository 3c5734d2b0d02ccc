// Interactive viewer: SDL2 for the window, splatlas::player for everything else.
//
//   viewer brain.atlas                  drag: orbit; right drag: pan; wheel: zoom; click: choose a structure;
//                                       T: hide or show it; Escape: quit
//   viewer brain.atlas SCRIPT OUT.png   plays "drag DX DY", "click X Y" and "key T", and saves the picture
//
// Drafts follow the mouse. The viewer refines the picture when no event is pending. The next event cancels
// the refinement through RenderControl, so the window stays responsive.
#include <cstdio>
#include <fstream>
#include <string>

#include <SDL.h>
#include <splatlas/player/camera_moves.h>
#include <splatlas/player/render_frame.h>
#include <splatlas/player/write_png.h>

using namespace splatlas;

class Viewer {
 public:
  Viewer(std::shared_ptr<const Atlas> atlas, SDL_Window* window)
      : atlas_(std::move(atlas)), window_(window), renderer_(atlas_) {
    selection_ = *select("*:surface", atlas_->graph());
    (void)renderer_.select(selection_);
  }

  void handle(const SDL_Event& event) {
    if (event.type == SDL_QUIT) quit_ = true;
    if (event.type == SDL_KEYDOWN) press(event.key.keysym.sym);
    if (event.type == SDL_WINDOWEVENT) shown_ = Shown::kNothing;  // resized, uncovered
    if (event.type == SDL_MOUSEBUTTONDOWN) dragged_ = false;
    if (event.type == SDL_MOUSEBUTTONUP && !dragged_) choose(event.button.x + 0.5, event.button.y + 0.5);
    if (event.type == SDL_MOUSEMOTION && event.motion.state != 0) {
      const int dx = event.motion.xrel, dy = event.motion.yrel;
      const bool orbits = (event.motion.state & SDL_BUTTON_LMASK) != 0;
      camera_ = orbits ? turned_by_drag(camera_, dx, dy, size())
                       : moved_by_drag(camera_, dx, dy, size(), atlas_->display());
      dragged_ = true;
      shown_ = Shown::kNothing;
    }
    if (event.type == SDL_MOUSEWHEEL) {
      const double factor = event.wheel.y > 0 ? 1.2 : 1 / 1.2;
      const int x = event.wheel.mouseX, y = event.wheel.mouseY;
      camera_ = zoomed_at(camera_, factor, x, y, size(), atlas_->display());
      shown_ = Shown::kNothing;
    }
  }

  /// Renders a draft, then the final picture unless an event interrupts it.
  void draw() {
    if (shown_ == Shown::kNothing && render(Quality::kDraft)) shown_ = Shown::kDraft;
    if (shown_ == Shown::kDraft && render(Quality::kNormal)) shown_ = Shown::kFinal;
  }
  bool is_finished() const { return shown_ == Shown::kFinal; }
  bool has_quit() const { return quit_; }
  bool save(const char* path) const { return write_png(picture_, path, Rgb{0, 0, 0}).has_value(); }

 private:
  enum class Shown { kNothing, kDraft, kFinal };

  PictureSize size() const {
    PictureSize size;
    SDL_GetWindowSize(window_, &size.width, &size.height);
    return size;
  }

  bool render(Quality quality) {
    std::stop_source stop;
    const auto stop_for_events = [&](double) {
      SDL_PumpEvents();
      if (SDL_HasEvents(SDL_FIRSTEVENT, SDL_LASTEVENT)) stop.request_stop();
    };
    RenderControl control;
    if (quality != Quality::kDraft) control = {.stop = stop.get_token(), .progress = stop_for_events};
    const auto rendered = renderer_.render(camera_, {.size = size(), .quality = quality}, picture_, control);
    if (!rendered) return rendered.error().code != ErrorCode::kCancelled;  // other errors are final
    auto rgb = to_srgb8(picture_, Rgb{0, 0, 0});
    const auto [w, h] = picture_.size;
    SDL_Surface* from =
        SDL_CreateRGBSurfaceWithFormatFrom(rgb.data(), w, h, 24, 3 * w, SDL_PIXELFORMAT_RGB24);
    SDL_BlitSurface(from, nullptr, SDL_GetWindowSurface(window_), nullptr);
    SDL_UpdateWindowSurface(window_);
    SDL_FreeSurface(from);
    return true;
  }

  void choose(double x, double y) {
    const auto pick = renderer_.pick(x, y);
    chosen_ = pick ? pick->structure : kNoStructure;
    const std::string name = pick ? printable(atlas_->graph()[chosen_].name) : "nothing";
    std::puts(name.c_str());
    SDL_SetWindowTitle(window_, name.c_str());
  }

  void press(SDL_Keycode key) {
    if (key == SDLK_ESCAPE) quit_ = true;
    if (key != SDLK_t || chosen_ == kNoStructure) return;
    DrawMode& mode = selection_.structures[chosen_].mode;
    mode = mode == DrawMode::kOff ? DrawMode::kSurface : DrawMode::kOff;
    (void)renderer_.select(selection_);  // never fails for surfaces only
    shown_ = Shown::kNothing;
  }

  std::shared_ptr<const Atlas> atlas_;
  SDL_Window* window_;
  Renderer renderer_;
  Selection selection_;
  Camera camera_;
  Picture picture_;
  StructureIndex chosen_ = kNoStructure;
  Shown shown_ = Shown::kNothing;
  bool dragged_ = false, quit_ = false;
};

/// Pushes the events of the next script command.
void push_next(std::istream& script) {
  std::string what, key;
  int x = 0, y = 0;
  const auto push = [](SDL_Event event) { SDL_PushEvent(&event); };
  if (!(script >> what)) return push({.type = SDL_QUIT});
  if (what == "key" && script >> key)
    return push({.key = {.type = SDL_KEYDOWN, .keysym = {.sym = SDL_GetKeyFromName(key.c_str())}}});
  script >> x >> y;
  if (what == "drag")
    return push({.motion = {.type = SDL_MOUSEMOTION, .state = SDL_BUTTON_LMASK, .xrel = x, .yrel = y}});
  push({.button = {.type = SDL_MOUSEBUTTONDOWN, .x = x, .y = y}});
  push({.button = {.type = SDL_MOUSEBUTTONUP, .x = x, .y = y}});
}

int main(int argc, char** argv) {
  const auto atlas = argc > 1 ? Atlas::open(argv[1]) : fail(ErrorCode::kUsage, "usage: viewer ATLAS");
  if (!atlas || SDL_Init(SDL_INIT_VIDEO) != 0) {
    std::fprintf(stderr, "viewer: %s\n", atlas ? SDL_GetError() : printable(atlas.error().message).c_str());
    return 1;
  }
  const bool scripted = argc == 4;
  std::ifstream script(scripted ? argv[2] : "");
  const int any = SDL_WINDOWPOS_UNDEFINED;
  Viewer viewer(*atlas, SDL_CreateWindow("Splatlas", any, any, 640, 480, SDL_WINDOW_RESIZABLE));
  for (SDL_Event event; !viewer.has_quit();) {
    if (viewer.is_finished() && scripted) push_next(script);
    if (viewer.is_finished() && SDL_WaitEvent(&event) == 1) viewer.handle(event);
    while (SDL_PollEvent(&event) == 1) viewer.handle(event);
    viewer.draw();
  }
  SDL_Quit();
  return !scripted || viewer.save(argv[3]) ? 0 : 1;
}
