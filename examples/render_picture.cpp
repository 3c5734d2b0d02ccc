// Still picture of selected structures, from an atlas to a PNG file.
//
//   render_picture brain.atlas 'Cerebellum:surface(opacity=0.5) + Vermis*' picture.png
//
// Every function that can fail returns a Result: a value, or an Error with a code and one line of text.
// value_or_throw() is for programs that end at the first error. Opening an atlas reads its directory only; a
// picture reads the selected structures only.
#include <cstdio>
#include <string>

#include <splatlas/player/renderer.h>
#include <splatlas/player/write_png.h>

using namespace splatlas;

void run(const char* path, const char* text, const char* output) {
  const auto atlas = value_or_throw(Atlas::open(path));
  Renderer renderer(atlas);
  value_or_throw(renderer.select(value_or_throw(Selection::parse(text, atlas->graph()))));

  // Standard views look along an axis; Camera{.azimuth_deg = 30} gives any other direction. The selection
  // fills the picture.
  const RenderOptions options{.size = {640, 480}, .quality = Quality::kNormal};
  const Camera camera = value_or_throw(renderer.fit(Camera::of(NamedView::kLeft), options));
  const Frame frame = value_or_throw(renderer.render(camera, options));

  // Pictures are premultiplied linear RGBA; without a background, the PNG is transparent.
  value_or_throw(write_png(frame.picture, output, Rgb{0, 0, 0}));

  // Damage affects only its own structures. The picture shows the others.
  for (const MissingPart& part : frame.missing)
    std::fprintf(stderr, "%s\n", describe(part, atlas->graph()).c_str());
  if (!frame.missing.empty())
    throw std::runtime_error(std::string(path) + ": damaged; the picture is incomplete");
}

int main(int argc, char** argv) try {
  if (argc != 4) throw std::runtime_error("usage: render_picture ATLAS SELECTION OUT.png");
  run(argv[1], argv[2], argv[3]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "render_picture: %s\n", printable(error.what()).c_str());
  return 1;
}
