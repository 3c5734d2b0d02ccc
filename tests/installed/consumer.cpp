// Uses the installed headers and libraries alone: renders a selection of an atlas and tells how much it
// covers.
#include <cstdio>

#include <format/atlas_reader.h>
#include <format/selection.h>
#include <player/render_frame.h>

namespace {

/// The share of the picture that the selection covers, in percent.
splatlas::Result<double> coverage(const char* path, const char* text) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, splatlas::Atlas::open(path));
  SPLATLAS_ASSIGN_OR_RETURN(const auto selection, splatlas::select(text, atlas->graph()));
  splatlas::Renderer renderer(atlas);
  SPLATLAS_RETURN_IF_ERROR(renderer.select(selection));
  SPLATLAS_ASSIGN_OR_RETURN(const auto picture, renderer.render({}, {.size = {100, 100}}));
  int covered = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) covered += picture.at(x, y)[3] > 0;
  }
  return covered / 100.0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: consumer ATLAS SELECTION\n", stderr);
    return 2;
  }
  const auto percent = coverage(argv[1], argv[2]);
  if (!percent) {
    std::fprintf(stderr, "%s\n", percent.error().message.c_str());
    return splatlas::exit_status(percent.error().code);
  }
  std::printf("%.0f %%\n", *percent);
  return 0;
}
