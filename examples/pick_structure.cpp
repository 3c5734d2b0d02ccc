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

#include <splatlas/player/render_frame.h>

using namespace splatlas;

Result<void> run(const char* path, const char* text, const char* at_x, const char* at_y) {
  char* end[2] = {};
  const double x = std::strtod(at_x, &end[0]), y = std::strtod(at_y, &end[1]);
  if (end[0] == at_x || end[1] == at_y || *end[0] != 0 || *end[1] != 0)
    return fail(ErrorCode::kUsage, std::string("X and Y must be numbers: ") + at_x + " " + at_y);
  const auto atlas = Atlas::open(path);
  if (!atlas) return tl::unexpected(atlas.error());
  const auto selection = select(text, (*atlas)->graph());
  if (!selection) return tl::unexpected(selection.error());
  Renderer renderer(*atlas);
  if (const auto selected = renderer.select(*selection); !selected) return selected;

  const Camera camera{.projection = CameraProjection::kPerspective};
  const RenderOptions options{.size = {640, 480}, .quality = Quality::kDraft};
  const auto picture = renderer.render(camera, options);
  if (!picture) return tl::unexpected(picture.error());

  // Structures that a damaged file lacks cannot be picked.
  for (const MissingPart& part : renderer.missing())
    std::fprintf(stderr, "%s\n", describe(part, (*atlas)->graph()).c_str());
  if (!renderer.missing().empty()) return fail(ErrorCode::kInvalidAtlas, std::string(path) + ": damaged");

  const auto pick = renderer.pick(x, y);  // of the latest picture
  if (!pick) {
    std::puts("background");
    return {};
  }
  const Vec3& point = pick->point_lps_mm;
  std::printf("%s at L %.1f P %.1f S %.1f mm\n", printable((*atlas)->graph()[pick->structure].name).c_str(),
              point[0], point[1], point[2]);

  const auto view = view_of(camera, options.size, (*atlas)->display());
  if (!view) return tl::unexpected(view.error());
  if (const auto shown = view->picture_point(point))
    std::printf("shown at %.1f, %.1f, %.1f mm behind the centre\n", shown->x, shown->y, shown->depth_mm);
  return {};
}

int main(int argc, char** argv) {
  const auto done = argc == 5 ? run(argv[1], argv[2], argv[3], argv[4])
                              : fail(ErrorCode::kUsage, "usage: pick_structure ATLAS SELECTION X Y");
  if (!done) std::fprintf(stderr, "pick_structure: %s\n", printable(done.error().message).c_str());
  return done ? 0 : 1;
}
