// Renders a selection of an atlas into a PNG, seen from the left.
#include <cstdio>

#include <splatlas/player/render_frame.h>
#include <splatlas/player/write_png.h>

splatlas::Result<void> render(const char* path, const char* text, const char* output) {
  const auto atlas = splatlas::Atlas::open(path);
  if (!atlas) return tl::unexpected(atlas.error());
  const auto selection = splatlas::select(text, (*atlas)->graph());
  if (!selection) return tl::unexpected(selection.error());
  splatlas::Renderer renderer(*atlas);
  if (const auto selected = renderer.select(*selection); !selected) return selected;
  const auto camera = splatlas::Camera::of(splatlas::NamedView::kLeft);
  const auto picture = renderer.render(camera, {.size = {640, 480}});
  if (!picture) return tl::unexpected(picture.error());
  return splatlas::write_png(*picture, output, splatlas::Rgb{0, 0, 0});
}

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: render_selection ATLAS SELECTION OUT.png\n", stderr);
    return 2;
  }
  const auto rendered = render(argv[1], argv[2], argv[3]);
  if (rendered) return 0;
  std::fprintf(stderr, "render_selection: %s\n", rendered.error().message.c_str());
  return 1;
}
