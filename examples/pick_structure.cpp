// Picking: the structure at a point of a picture, and its position in the patient.
//
//   pick_structure brain.atlas '*:surface' 320 240
//
// Picture coordinates count pixels from the top left corner; (0.5, 0.5) is the centre of the first pixel.
// Points are in LPS millimetres: towards the subject's left, posterior and superior. A View projects points
// to the picture and unprojects them, in parallel and perspective projection.
#include <cstdio>
#include <cstdlib>
#include <string>

#include <splatlas/player/renderer.h>

using namespace splatlas;

double number(const char* text) {
  char* end = nullptr;
  const double number = std::strtod(text, &end);
  if (end == text || *end != 0) throw std::runtime_error(std::string("X and Y must be numbers: ") + text);
  return number;
}

void run(const char* path, const char* text, double x, double y) {
  const auto atlas = value_or_throw(Atlas::open(path));
  Renderer renderer(atlas);
  value_or_throw(renderer.select(value_or_throw(Selection::parse(text, atlas->graph()))));
  const Camera camera{.projection = CameraProjection::kPerspective};
  const RenderOptions options{.size = {640, 480}, .quality = Quality::kDraft};
  const Frame frame = value_or_throw(renderer.render(camera, options));

  // Structures that a damaged file lacks cannot be picked.
  for (const MissingPart& part : frame.missing)
    std::fprintf(stderr, "%s\n", describe(part, atlas->graph()).c_str());
  if (!frame.missing.empty()) throw std::runtime_error(std::string(path) + ": damaged");

  const auto pick = frame.pick(x, y);
  if (!pick) {
    std::puts("background");
    return;
  }
  const Vec3& point = pick->point_lps_mm;
  std::printf("%s at L %.1f P %.1f S %.1f mm\n", printable(atlas->graph()[pick->structure].name).c_str(),
              point[0], point[1], point[2]);
  const View view = value_or_throw(view_of(camera, options.size, atlas->display()));
  if (const auto shown = view.picture_point(point))
    std::printf("shown at %.1f, %.1f, %.1f mm behind the centre\n", shown->x, shown->y, shown->depth_mm);
}

int main(int argc, char** argv) try {
  if (argc != 5) throw std::runtime_error("usage: pick_structure ATLAS SELECTION X Y");
  run(argv[1], argv[2], number(argv[3]), number(argv[4]));
} catch (const std::exception& error) {
  std::fprintf(stderr, "pick_structure: %s\n", printable(error.what()).c_str());
  return 1;
}
