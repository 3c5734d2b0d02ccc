// Annotated page for print: labels, legend and scale bar around the selected structures.
//
//   render_page brain.atlas 'Cerebellum + Vermis*:surface' page.pdf
//
// The ending of the file decides about its format: .png, .jpg, .tif, .exr, .svg or .pdf. write_picture() does
// the same for a picture without annotations.
#include <cstdio>
#include <fstream>

#include <splatlas/player/render_page.h>

using namespace splatlas;

void run(const char* path, const char* text, const char* output) {
  PageOptions options{.background = Rgb{255, 255, 255}};
  options.render.size = {1654, 1169};  // A5 at 200 dpi
  options.items = {.labels = true, .legend = true, .scale_bar = true, .caption = true};
  options.caption = text;
  options.dpi = 200;
  PageRenderer pages = value_or_throw(PageRenderer::create(output, options));  // loads libraries meanwhile

  const auto atlas = value_or_throw(Atlas::open(path));
  Renderer renderer(atlas);
  value_or_throw(renderer.select(value_or_throw(Selection::parse(text, atlas->graph()))));
  Page page = value_or_throw(pages.render(renderer, Camera::of(NamedView::kLeft)));
  const std::vector<std::byte> bytes = value_or_throw(pages.encode(page));
  std::ofstream file(output, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::runtime_error(std::string(output) + ": cannot be written");

  for (const std::string& note : page.annotations.notes) std::fprintf(stderr, "note: %s\n", note.c_str());
  for (const MissingPart& part : page.frame.missing)
    std::fprintf(stderr, "%s\n", describe(part, atlas->graph()).c_str());
}

int main(int argc, char** argv) try {
  if (argc != 4) throw std::runtime_error("usage: render_page ATLAS SELECTION OUT");
  run(argv[1], argv[2], argv[3]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "render_page: %s\n", printable(error.what()).c_str());
  return 1;
}
