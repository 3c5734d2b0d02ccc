// Framing of a picture on the command line: --fit and --center.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "player/render_frame.h"

namespace CLI {
class App;
}

namespace splatlas {

/// Content that fills the picture at zoom 1.
enum class Fit : std::uint8_t { kSelection, kGrid };

/// Middle of the picture: that of the fit, a point in LPS mm, or a name of the selection language.
using FrameCenter = std::variant<std::monostate, Vec3, std::string>;

struct Framing {
  Fit fit = Fit::kSelection;
  FrameCenter center;
};

/// Adds the options. Parsing fills `framing`, which must outlive the command.
void add_framing(CLI::App& command, Framing& framing);

/// The camera with the zoom of the fit to `region`, multiplied by its own, around the centre of the framing.
/// A centre does not change the zoom. The renderer's selection must be that of the picture. kNotFound for
/// unknown names; kFailed for structures without voxels; kUsage if the product of the zooms is beyond the
/// limits; the errors of Renderer::fit().
[[nodiscard]] Result<Camera> framed(const Camera& camera, const Framing& framing,
                                    const RenderOptions& options, Renderer& renderer,
                                    const PictureRegion& region = {});

}  // namespace splatlas
