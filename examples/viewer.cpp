// Interactive viewer: SDL2 for the window, splatlas::player for everything else.
//
//   viewer brain.atlas     drag: orbit; right drag: pan; wheel: zoom; click: choose a structure; T: hide it
//
// Drafts follow the mouse. The viewer refines the picture when no event is pending. The next event cancels
// the refinement through RenderControl, so the window stays responsive. A click then picks in the draft.
#include <cmath>
#include <cstdio>

#include <SDL.h>
#include <splatlas/player/camera_moves.h>
#include <splatlas/player/renderer.h>

using namespace splatlas;

struct Viewer {
  Renderer renderer;
  SDL_Window* window;
  Selection selection = value_or_throw(Selection::parse("*:surface", renderer.atlas().graph()));
  Camera camera = {};
  Frame frame = {};
  std::optional<Pick> pick = {};
  std::optional<Quality> shown = {};  // of the camera and the selection
  bool dragged = false, quit = false;

  void run() {
    value_or_throw(renderer.select(selection));
    for (SDL_Event event; !quit;) {
      if (shown == Quality::kNormal && SDL_WaitEvent(&event) == 1) handle(event);
      while (SDL_PollEvent(&event) == 1) handle(event);
      if (!shown) render(Quality::kDraft);
      if (shown == Quality::kDraft) render(Quality::kNormal);
    }
  }

  void handle(const SDL_Event& event) {
    const bool drags = event.type == SDL_MOUSEMOTION && event.motion.state != 0;
    if (event.type == SDL_QUIT) quit = true;
    if (event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_t && pick) toggle(pick->structure);
    if (event.type == SDL_MOUSEBUTTONUP && !dragged) choose(event.button.x + 0.5, event.button.y + 0.5);
    if (event.type == SDL_MOUSEBUTTONDOWN || drags) dragged = drags;
    if (drags || event.type == SDL_MOUSEWHEEL || event.type == SDL_WINDOWEVENT) shown.reset();
    const PictureSize size = frame.picture.size;
    const int dx = event.motion.xrel, dy = event.motion.yrel;
    if (drags)
      camera = (event.motion.state & SDL_BUTTON_LMASK) != 0
                   ? turned_by_drag(camera, dx, dy, size)
                   : moved_by_drag(camera, dx, dy, size, renderer.atlas().display());
    if (event.type == SDL_MOUSEWHEEL)
      camera = zoomed_at(camera, std::pow(1.2, event.wheel.y), event.wheel.mouseX, event.wheel.mouseY, size,
                         renderer.atlas().display());
  }

  void render(Quality quality) {
    std::stop_source stop;
    RenderControl control{.stop = stop.get_token(), .progress = [&](double) {
                            SDL_PumpEvents();
                            if (SDL_HasEvents(SDL_FIRSTEVENT, SDL_LASTEVENT)) stop.request_stop();
                          }};
    if (quality == Quality::kDraft) control = {};
    PictureSize size;
    SDL_GetWindowSize(window, &size.width, &size.height);
    auto rendered = renderer.render(camera, {.size = size, .quality = quality}, control);
    if (!rendered && rendered.error().code == ErrorCode::kCancelled) return;
    frame = value_or_throw(std::move(rendered));
    shown = quality;
    if (!frame.missing.empty())
      SDL_SetWindowTitle(window, describe(frame.missing[0], renderer.atlas().graph()).c_str());
    std::vector<std::uint8_t> rgb = to_srgb8(frame.picture, Rgb{0, 0, 0});
    SDL_Surface* surface = SDL_CreateRGBSurfaceWithFormatFrom(rgb.data(), size.width, size.height, 24,
                                                              3 * size.width, SDL_PIXELFORMAT_RGB24);
    SDL_BlitSurface(surface, nullptr, SDL_GetWindowSurface(window), nullptr);
    SDL_FreeSurface(surface);
    SDL_UpdateWindowSurface(window);
  }

  void choose(double x, double y) {
    pick = frame.pick(x, y);
    const auto name = pick ? printable(renderer.atlas().graph()[pick->structure].name) : "nothing";
    SDL_SetWindowTitle(window, name.c_str());
  }

  void toggle(StructureIndex structure) {
    DrawMode& mode = selection.structures[structure].mode;
    mode = mode == DrawMode::kOff ? DrawMode::kSurface : DrawMode::kOff;
    value_or_throw(renderer.select(selection));
    shown.reset();
  }
};

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("usage: viewer ATLAS");
  SDL_Init(SDL_INIT_VIDEO);
  SDL_Window* window = SDL_CreateWindow("Splatlas", 0, 0, 640, 480, SDL_WINDOW_RESIZABLE);
  if (window == nullptr) throw std::runtime_error(SDL_GetError());
  Viewer{Renderer(value_or_throw(Atlas::open(argv[1]))), window}.run();
} catch (const std::exception& error) {
  std::fprintf(stderr, "viewer: %s\n", printable(error.what()).c_str());
  return 1;
}
