// Renderer of atlas selections, and its frames.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "format/atlas_reader.h"
#include "format/content/selection.h"
#include "player/camera.h"
#include "player/picture.h"
#include "player/render_options.h"

namespace splatlas {

/// Everything that one call of Renderer::render() makes.
struct Frame {
  Picture picture;
  IdImage ids;      ///< empty unless RenderOptions::ids
  DepthMap depths;  ///< empty unless RenderOptions::depths
  RenderStats stats;
  /// Unreadable parts of the selection, among those that its frames have needed. Empty for intact files.
  std::vector<MissingPart> missing;

  /// Casts a ray through picture coordinates (x, y). Returns the structure with the largest contribution to
  /// the pixel, and the point of its largest contribution in LPS mm. None for the background, outside the
  /// picture, and once the renderer has another selection, has found more missing parts, or is destroyed.
  ///
  /// Cost: a binary search among the decoded runs of each slice, and the samples of surfaces in the picture
  /// row. After ray casting, also linear in the classes of the atlas. Rasterises the surfaces again if the
  /// renderer has begun another frame since. Not thread-safe, as the renderer. Throws std::bad_alloc.
  [[nodiscard]] std::optional<Pick> pick(double x, double y) const {
    return picker ? picker(x, y, ids) : std::nullopt;
  }

  /// Set by the renderer.
  std::function<std::optional<Pick>(double x, double y, const IdImage& ids)> picker;
};

/// The structures of Frame::pick() in a frame, which must live as long.
[[nodiscard]] inline auto structure_at(const Frame& frame) {
  return [&frame](double x, double y) {
    const std::optional<Pick> found = frame.pick(x, y);
    return found ? found->structure : kNoStructure;
  };
}

/// Renders one selection of an atlas at a time. Caches decoded data: a new selection reads only additional
/// chunks. Owns a thread pool. Not thread-safe: serialise all calls on one renderer.
class Renderer {
 public:
  /// Starts the threads, or fewer if the system refuses them. Nothing is selected. Throws std::bad_alloc.
  explicit Renderer(std::shared_ptr<const Atlas> atlas, const RendererOptions& options = {});
  Renderer(Renderer&&) noexcept = default;
  Renderer& operator=(Renderer&&) noexcept = default;

  [[nodiscard]] const Atlas& atlas() const;
  [[nodiscard]] const Selection& selection() const;

  /// Replaces the selection. render() reads and decodes its data later. Errors:
  ///   - kUsage, keeping the old selection, for an invalid selection (see check_selection()).
  ///   - kLimit, with an empty selection, when out of memory.
  /// Cost: the draw plan of the selection.
  [[nodiscard]] Result<void> select(const Selection& selection);

  /// Renders the selection. The picture is bit-identical for any number of threads.
  ///
  /// Errors keep the selection and the decoded data:
  ///   - kUsage for an invalid camera or picture size (see view_of()). Also for a perspective field of view
  ///     that is too wide for surfaces: above about 70 degrees, from oblique directions.
  ///   - kLimit when the picture exceeds the allowed memory, before any read or allocation, or when out of
  ///     memory. Also when ids or depths of a volume need more: rays walk through it.
  ///   - kCancelled after a stop request in `control`. All threads check it every few milliseconds. Later
  ///     pictures do not depend on cancelled ones.
  ///   - The read error if damage of the file leaves nothing to draw. Otherwise the intact parts are drawn;
  ///     see Frame::missing.
  ///
  /// Cost:
  ///   - sheets: selected voxels in view * sheet pixels per voxel * slabs per slice
  ///   - rays: pixels * rays per pixel * steps through non-empty bricks
  ///   - both: selected triangles and pixels; once per selection also the runs in its bounding box
  [[nodiscard]] Result<Frame> render(const Camera& camera, const RenderOptions& options = {},
                                     const RenderControl& control = {});
  /// The same, reusing the memory of `frame`: page faults of a new one cost as much as a small frame. After
  /// an error the content of `frame` is unspecified.
  [[nodiscard]] Result<void> render(const Camera& camera, const RenderOptions& options, Frame& frame,
                                    const RenderControl& control = {});

  /// Fits a camera to the selection, as render() draws it with these options. Returns the camera with the
  /// centre and zoom at which the selected voxels and surfaces fill `region` of the picture, but for margins
  /// of 2 %. Keeps its direction and projection; ignores its own zoom and centre. Multiply the zoom to see
  /// more or less around the same centre.
  ///
  /// The fit holds for one direction, and is tight for oblique ones, too. A volume extends to the centres of
  /// the next voxels, up to which interpolation spreads it. Parts that cuts remove do not count; a cut volume
  /// may leave up to two voxels of room. `structures`: fits to the part of the selection in these structures
  /// (without their descendants). Without anything to draw: zoom 1, and the bounding sphere's centre.
  ///
  /// Reads and decodes the data of the picture, and nothing else; for drafts within a budget only the runs,
  /// with those of damaged values, and surfaces that are quick to derive, which may reach some voxels less or
  /// more. Damaged parts do not count; the next frame lists them. The result does not depend on the number of
  /// threads. Errors as for render(), and kUsage for an invalid region. Cost: linear
  /// in the runs in the selection's bounding box and in the vertices of its surfaces.
  [[nodiscard]] Result<Camera> fit(const Camera& camera, const RenderOptions& options = {},
                                   std::optional<std::span<const StructureIndex>> structures = std::nullopt,
                                   const PictureRegion& region = {}, const RenderControl& control = {});

  /// Frees what only makes the next pictures faster: buffers of frames, and spans of earlier axes.
  void rest();

 private:
  friend struct RendererInternals;
  struct Impl;
  std::shared_ptr<Impl> impl_;  // frames hold weak references
};

}  // namespace splatlas
