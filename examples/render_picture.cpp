// Still picture of selected structures, from an atlas to a PNG file.
//
//   render_picture brain.atlas 'Cerebellum:surface(opacity=0.5) + Vermis*' picture.png
//
// Every function that can fail returns a Result: a value, or an Error with a code and one line of text.
// Opening an atlas reads its directory only; a picture reads the selected structures only.
#include <cstdio>
#include <string>

#include <splatlas/player/render_frame.h>
#include <splatlas/player/write_png.h>

using namespace splatlas;

Result<void> run(const char* path, const char* text, const char* output) {
  const auto atlas = Atlas::open(path);
  if (!atlas) return tl::unexpected(atlas.error());
  const auto selection = select(text, (*atlas)->graph());
  if (!selection) return tl::unexpected(selection.error());

  Renderer renderer(*atlas);
  if (const auto selected = renderer.select(*selection); !selected) return selected;

  // Standard views look along an axis; Camera{.azimuth_deg = 30} gives any other direction. The selection
  // fills the picture.
  const RenderOptions options{.size = {640, 480}, .quality = Quality::kNormal};
  const auto camera = renderer.fit(Camera::of(NamedView::kLeft), options);
  if (!camera) return tl::unexpected(camera.error());
  const auto picture = renderer.render(*camera, options);
  if (!picture) return tl::unexpected(picture.error());

  // Pictures are premultiplied linear RGBA; without a background, the PNG is transparent.
  if (auto written = write_png(*picture, output, Rgb{0, 0, 0}); !written) return written;

  // Damage affects only its own structures. The picture shows the others.
  for (const MissingPart& part : renderer.missing())
    std::fprintf(stderr, "%s\n", describe(part, (*atlas)->graph()).c_str());
  if (renderer.missing().empty()) return {};
  return fail(ErrorCode::kInvalidAtlas, std::string(path) + ": damaged; the picture is incomplete");
}

int main(int argc, char** argv) {
  const auto done = argc == 4 ? run(argv[1], argv[2], argv[3])
                              : fail(ErrorCode::kUsage, "usage: render_picture ATLAS SELECTION OUT.png");
  if (!done) std::fprintf(stderr, "render_picture: %s\n", printable(done.error().message).c_str());
  return done ? 0 : 1;
}
