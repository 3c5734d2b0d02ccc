// Interactive viewer: SDL2 for the window, splatlas::player for everything else.
//
//   viewer brain.atlas                  drag: orbit; right drag: pan; wheel: zoom; click: choose a structure;
//                                       T: hide or show it; Escape: quit
//   viewer brain.atlas SCRIPT OUT.png   plays "drag DX DY", "click X Y" and "key T" like a user in a hurry,
//                                       each while the picture is refined, and saves the last picture
//
// Drafts follow the mouse. The viewer refines the picture when no event is pending. The next event cancels
// the refinement through RenderControl, so the window stays responsive. A click then picks in the draft.
#include <SDL.h>
#include <splatlas/player/camera_moves.h>
#include <splatlas/player/render_frame.h>
#include <splatlas/player/write_png.h>

#include "viewer_script.h"

using namespace splatlas;

class Viewer {
 public:
  Viewer(std::shared_ptr<const Atlas> atlas, const Selection& selection, SDL_Window* window, Script& script)
      : renderer_(std::move(atlas)), selection_(selection), window_(window), script_(script) {}

  /// Runs until the user quits or the script ends, then saves the picture. Damage is an error at the end.
  Result<void> run(const char* output) {
    for (SDL_Event event; !quit_ && state_;) {
      const bool is_finished = shown_ == Shown::kFinal;
      if (is_finished && script_.is_open() && !script_.push_next()) break;
      if (is_finished && SDL_WaitEvent(&event) == 1) handle(event);
      while (SDL_PollEvent(&event) == 1) handle(event);
      if (state_ && shown_ == Shown::kNothing) render(Quality::kDraft, Shown::kDraft);
      if (state_ && shown_ == Shown::kDraft) render(Quality::kNormal, Shown::kFinal);
    }
    if (state_) state_ = script_.check();
    if (state_ && output) state_ = write_png(picture_, output, Rgb{0, 0, 0});
    return state_ && told_ > 0 ? fail(ErrorCode::kInvalidAtlas, "the atlas is damaged") : state_;
  }

 private:
  enum class Shown { kNothing, kDraft, kFinal };

  PictureSize size() const {
    PictureSize size;
    SDL_GetWindowSize(window_, &size.width, &size.height);
    return size;
  }

  void handle(const SDL_Event& event) {
    const bool drags = event.type == SDL_MOUSEMOTION && event.motion.state != 0;
    if (event.type == SDL_QUIT) quit_ = true;
    if (event.type == SDL_KEYDOWN) press(event.key.keysym.sym);
    if (event.type == SDL_MOUSEBUTTONUP && !dragged_) choose(event.button.x + 0.5, event.button.y + 0.5);
    if (event.type == SDL_MOUSEBUTTONDOWN || drags) dragged_ = drags;
    if (drags || event.type == SDL_MOUSEWHEEL || event.type == SDL_WINDOWEVENT) shown_ = Shown::kNothing;
    if (drags) {
      const int dx = event.motion.xrel, dy = event.motion.yrel;
      const bool orbits = (event.motion.state & SDL_BUTTON_LMASK) != 0;
      camera_ = orbits ? turned_by_drag(camera_, dx, dy, size())
                       : moved_by_drag(camera_, dx, dy, size(), renderer_.atlas().display());
    }
    if (event.type == SDL_MOUSEWHEEL) {
      const double factor = event.wheel.y > 0 ? 1.2 : 1 / 1.2;
      const int x = event.wheel.mouseX, y = event.wheel.mouseY;
      camera_ = zoomed_at(camera_, factor, x, y, size(), renderer_.atlas().display());
    }
  }

  void render(Quality quality, Shown shown) {
    std::stop_source stop;
    const auto stop_for_events = [&](double fraction) {
      if (fraction >= 0.5 && !stop.stop_requested()) script_.push_next();
      SDL_PumpEvents();
      if (SDL_HasEvents(SDL_FIRSTEVENT, SDL_LASTEVENT)) stop.request_stop();
    };
    RenderControl control;
    if (quality != Quality::kDraft) control = {.stop = stop.get_token(), .progress = stop_for_events};
    state_ = renderer_.render(camera_, {.size = size(), .quality = quality}, picture_, control);
    if (state_) show(shown);
    if (!state_ && state_.error().code == ErrorCode::kCancelled) state_ = {};
  }

  void show(Shown shown) {
    for (; told_ < renderer_.missing().size(); ++told_)
      std::fprintf(stderr, "viewer: %s\n",
                   describe(renderer_.missing()[told_], renderer_.atlas().graph()).c_str());
    const auto [w, h] = picture_.size;
    rgb_.resize(picture_.rgba.size() / 4 * 3);
    state_ = to_srgb8(picture_, Rgb{0, 0, 0}, rgb_);
    SDL_Surface* rgb =
        SDL_CreateRGBSurfaceWithFormatFrom(rgb_.data(), w, h, 24, 3 * w, SDL_PIXELFORMAT_RGB24);
    const bool copied = SDL_BlitSurface(rgb, nullptr, SDL_GetWindowSurface(window_), nullptr) == 0;
    SDL_FreeSurface(rgb);
    if (!copied || SDL_UpdateWindowSurface(window_) != 0) state_ = fail(ErrorCode::kFailed, SDL_GetError());
    shown_ = shown;
  }

  void choose(double x, double y) {
    const auto pick = renderer_.pick(x, y);
    chosen_ = pick ? pick->structure : kNoStructure;
    const std::string name = pick ? printable(renderer_.atlas().graph()[chosen_].name) : "nothing";
    std::puts(name.c_str());
    SDL_SetWindowTitle(window_, name.c_str());
  }

  void press(SDL_Keycode key) {
    if (key == SDLK_ESCAPE) quit_ = true;
    if (key != SDLK_t || chosen_ == kNoStructure) return;
    DrawMode& mode = selection_.structures[chosen_].mode;
    mode = mode == DrawMode::kOff ? DrawMode::kSurface : DrawMode::kOff;
    state_ = renderer_.select(selection_);
    shown_ = Shown::kNothing;
  }

  Renderer renderer_;
  Selection selection_;
  SDL_Window* window_;
  Script& script_;
  Result<void> state_ = renderer_.select(selection_);
  Camera camera_;
  Picture picture_;
  std::vector<std::uint8_t> rgb_;
  StructureIndex chosen_ = kNoStructure;
  Shown shown_ = Shown::kNothing;
  std::size_t told_ = 0;
  bool dragged_ = false, quit_ = false;
};

Result<void> run(const char* path, const char* script_path, const char* output) {
  const auto atlas = Atlas::open(path);
  if (!atlas) return tl::unexpected(atlas.error());
  const auto selection = select("*:surface", (*atlas)->graph());
  if (!selection) return tl::unexpected(selection.error());
  Script script;
  if (const auto opened = output ? script.open(script_path) : Result<void>(); !opened) return opened;
  const int any = SDL_WINDOWPOS_UNDEFINED;
  SDL_Window* window = SDL_Init(SDL_INIT_VIDEO) != 0
                           ? nullptr
                           : SDL_CreateWindow("Splatlas", any, any, 640, 480, SDL_WINDOW_RESIZABLE);
  if (window == nullptr) return fail(ErrorCode::kFailed, SDL_GetError());
  return Viewer(*atlas, *selection, window, script).run(output);
}

int main(int argc, char** argv) {
  const auto done = argc == 2 || argc == 4 ? run(argv[1], argv[2], argc == 4 ? argv[3] : nullptr)
                                           : fail(ErrorCode::kUsage, "usage: viewer ATLAS [SCRIPT OUT.png]");
  if (!done) std::fprintf(stderr, "viewer: %s\n", printable(done.error().message).c_str());
  SDL_Quit();
  return done ? 0 : 1;
}
