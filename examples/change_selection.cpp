// Change of a selection: one structure as volume inside the surfaces of the others, then a close-up.
//
//   change_selection brain.atlas Putamen_L out      (writes out-1.png and out-2.png)
//
// A Selection has an entry for each structure. A program changes entries and selects again. The renderer
// caches decoded data and reads only additional chunks.
#include <cstdio>
#include <string>

#include <splatlas/player/renderer.h>
#include <splatlas/player/transfer_function.h>
#include <splatlas/player/write_png.h>

using namespace splatlas;

void run(const char* path, const char* name, const std::string& prefix) {
  const auto atlas = value_or_throw(Atlas::open(path));
  const StructureGraph& graph = atlas->graph();
  Selection selection = value_or_throw(Selection::parse("*:surface(opacity=0.1)", graph));
  const auto found = value_or_throw(graph.find(name));  // several for a name with wildcards
  const auto changed = graph.descendants(found);
  for (const StructureIndex s : changed) {
    StructureDraw& draw = selection.structures[s];
    draw.mode = DrawMode::kVolume;
    draw.opacity = 0.5f;
    draw.volume.profile = TransferProfile::kHard;  // low and high default to the display window
  }
  const TransferCurve curve = transfer_curve(selection.structures[found.front()], atlas->display());
  for (const TransferPoint& point : curve.points)
    std::printf("grey %g: opacity %g\n", point.grey, static_cast<double>(point.opacity));

  Renderer renderer(atlas);
  value_or_throw(renderer.select(selection));
  const RenderOptions options{.size = {640, 480}};
  const Camera whole = value_or_throw(renderer.fit({}, options));
  const Camera close = value_or_throw(renderer.fit({}, options, changed));
  for (const auto& [camera, ending] : {std::pair(whole, "-1.png"), std::pair(close, "-2.png")}) {
    const Frame frame = value_or_throw(renderer.render(camera, options));
    value_or_throw(write_png(frame.picture, prefix + ending, Rgb{0, 0, 0}));
    if (!frame.missing.empty())
      throw std::runtime_error("incomplete pictures: " + describe(frame.missing[0], graph));
  }
}

int main(int argc, char** argv) try {
  if (argc != 4) throw std::runtime_error("usage: change_selection ATLAS STRUCTURE PREFIX");
  run(argv[1], argv[2], argv[3]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "change_selection: %s\n", printable(error.what()).c_str());
  return 1;
}
