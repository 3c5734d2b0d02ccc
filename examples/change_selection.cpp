// Change of a selection: one structure as volume inside the surfaces of the others, then a close-up.
//
//   change_selection brain.atlas Putamen_L out      (writes out-1.png and out-2.png)
//
// A Selection has an entry for each structure. A program changes entries and selects again. The renderer
// caches decoded data and reads only additional chunks.
#include <cstdio>
#include <string>

#include <splatlas/player/render_frame.h>
#include <splatlas/player/transfer_function.h>
#include <splatlas/player/write_png.h>

using namespace splatlas;

Result<void> run(const char* path, const char* name, const std::string& prefix) {
  const auto atlas = Atlas::open(path);
  if (!atlas) return tl::unexpected(atlas.error());
  const StructureGraph& graph = (*atlas)->graph();
  auto selection = select("*:surface(opacity=0.1)", graph);
  if (!selection) return tl::unexpected(selection.error());
  const auto found = find_structures(graph, name);
  if (!found) return tl::unexpected(found.error());
  for (const StructureIndex top : *found) {
    for (const StructureIndex s : graph.descendants(top)) {
      StructureDraw& draw = selection->structures[s];
      draw.mode = DrawMode::kVolume;
      draw.opacity = 0.5f;
      draw.volume.profile = TransferProfile::kHard;  // low and high default to the display window
    }
  }
  const TransferCurve curve = transfer_curve(selection->structures[found->front()], (*atlas)->display());
  for (const TransferPoint& point : curve.points)
    std::printf("grey %g: opacity %g\n", point.grey, static_cast<double>(point.opacity));

  Renderer renderer(*atlas);
  if (const auto selected = renderer.select(*selection); !selected) return selected;
  RenderOptions options{.size = {640, 480}};
  const auto whole = renderer.fit({}, options);
  if (!whole) return tl::unexpected(whole.error());
  auto picture = renderer.render(*whole, options);
  if (!picture) return tl::unexpected(picture.error());
  if (auto written = write_png(*picture, prefix + "-1.png", Rgb{0, 0, 0}); !written) return written;

  const auto close = renderer.fit({}, options, graph.descendants(*found));
  if (!close) return tl::unexpected(close.error());
  picture = renderer.render(*close, options);
  if (!picture) return tl::unexpected(picture.error());
  if (auto written = write_png(*picture, prefix + "-2.png", Rgb{0, 0, 0}); !written) return written;
  if (renderer.missing().empty()) return {};
  return fail(ErrorCode::kInvalidAtlas, "incomplete pictures: " + describe(renderer.missing()[0], graph));
}

int main(int argc, char** argv) {
  const auto done = argc == 4 ? run(argv[1], argv[2], argv[3])
                              : fail(ErrorCode::kUsage, "usage: change_selection ATLAS STRUCTURE PREFIX");
  if (!done) std::fprintf(stderr, "change_selection: %s\n", printable(done.error().message).c_str());
  return done ? 0 : 1;
}
