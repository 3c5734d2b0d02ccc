// Renders a selection of an atlas into a PNG, seen from the left.
#include <cstdio>

#include <splatlas/player/render_frame.h>
#include <splatlas/player/write_png.h>

splatlas::Result<void> render(const char* path, const char* text, const char* output) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, splatlas::Atlas::open(path));
  SPLATLAS_ASSIGN_OR_RETURN(const auto selection, splatlas::select(text, atlas->graph()));
  splatlas::Renderer renderer(atlas);
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  const auto camera = splatlas::Camera::of(splatlas::NamedView::kLeft);
  SPLATLAS_ASSIGN_OR_RETURN(const auto picture, renderer.render(camera, {.size = {640, 480}}));
  return splatlas::write_png(picture, output, splatlas::Rgb{0, 0, 0});
}

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: render_selection ATLAS SELECTION OUT.png\n", stderr);
    return 2;
  }
  const auto rendered = render(argv[1], argv[2], argv[3]);
  if (rendered) return 0;
  std::fprintf(stderr, "render_selection: %s\n", rendered.error().message.c_str());
  return splatlas::exit_status(rendered.error().code);
}
