// Renders selections of an atlas: the way in for programs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "format/atlas_reader.h"
#include "format/selection.h"
#include "player/camera.h"
#include "player/missing_parts.h"
#include "player/picture.h"
#include "player/render_options.h"

namespace splatlas {

struct RenderOverrides;

/// An atlas with one selection. Keeps what it has decoded: a new selection reads only what is new.
/// Not for use by several threads at once; works on its own threads inside.
class Renderer {
 public:
  explicit Renderer(std::shared_ptr<const Atlas> atlas, const RendererOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  [[nodiscard]] const Atlas& atlas() const;

  /// Changes what is drawn. Reading and decoding wait until a view is rendered. kLimit, and the old selection
  /// stays, when it would need more memory than allowed; kLimit, and nothing is selected, when there is none.
  [[nodiscard]] Result<void> select(const Selection& selection);

  /// Renders the selection. Same selection, camera and options: same bits, with any number of threads.
  /// kLimit, before anything is read or allocated, when the picture would need more memory than allowed, and
  /// when there is no more: the selection stays, and what was decoded.
  /// Where the file is damaged, the rest is drawn: see missing(). An error where nothing is left to draw.
  /// Cost: selected voxels in view * sheet pixels per voxel * slabs per slice, selected triangles, pixels;
  /// after a change of selection also the decoded runs in its box.
  /// kCancelled when `control` asks for a stop, checked every few milliseconds on every thread: the selection
  /// stays, and later pictures are the same bits as without.
  [[nodiscard]] Result<Picture> render(const Camera& camera, const RenderOptions& options = {},
                                       const RenderControl& control = {});
  /// The same into a picture whose memory is reused: fresh pages cost as much as a small frame. On failure
  /// the picture holds anything.
  [[nodiscard]] Result<void> render(const Camera& camera, const RenderOptions& options, Picture& picture,
                                    const RenderControl& control = {});

  /// Of the latest render().
  [[nodiscard]] const RenderStats& stats() const;
  /// What the pictures of the current selection lack, as far as it has been needed: empty but for damaged
  /// files. Tried again after the next change of selection.
  [[nodiscard]] const std::vector<MissingPart>& missing() const;

  /// The structure that contributes most to the picture at picture coordinates (x, y) of the latest render(),
  /// and where on the ray; nothing where the background shows, and after a call that was refused,
  /// failed or cancelled while it drew. In frames of sheets and of rays. Cost: one look-up per slice.
  [[nodiscard]] std::optional<Pick> pick(double x, double y) const;

 private:
  friend Result<void> render_with(Renderer& renderer, const Camera& camera, const RenderOptions& options,
                                  const RenderOverrides& overrides, Picture& picture,
                                  const RenderControl& control);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
