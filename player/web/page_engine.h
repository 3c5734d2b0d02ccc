// The player behind a page: answers requests as JSON, in a WebAssembly module as in a server. Its atlas may
// arrive in pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/result.h"
#include "player/renderer.h"
#include "player/web/page_slices.h"

namespace splatlas {

struct ByteRange {
  std::uint64_t offset = 0, bytes = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// Pieces of a file on a server. What a read misses is noted; someone gives it, and reads again. Thread-safe.
class RemoteBytes {
 public:
  /// Fills `to` from `offset`, out of one piece. kFailed if no piece holds the range.
  [[nodiscard]] Result<void> read(std::uint64_t offset, std::span<std::byte> to);
  void give(std::uint64_t offset, std::vector<std::byte> bytes);
  /// The ranges that reads have missed since the last call, in order and without gaps of a few KiB.
  [[nodiscard]] std::vector<ByteRange> take_missed();

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::vector<std::byte>> pieces_;
  std::vector<ByteRange> missed_;
};

/// An answer: 0 and a text, usually JSON, or 1 + ErrorCode and a message of one line.
struct PageAnswer {
  int status = 0;
  std::string text;
  bool has_picture = false;  ///< PageEngine::frame() is the picture that was asked for
  std::string subject = {};  ///< of the error
};

/// An atlas with one selection and the latest picture. Not thread-safe.
class PageEngine {
 public:
  explicit PageEngine(const RendererOptions& options = {}) : options_(options) {}

  /// Plays an atlas in place of the one before. Nothing is selected. Throws std::bad_alloc.
  void open(std::shared_ptr<const Atlas> atlas);

  /// Answers a request, a JSON object {"call": NAME, ...}, and `bytes` for "open" and "give". Errors keep the
  /// selection. Never throws. Requests with their answers; see page_state_of() for a state:
  ///
  ///   - open: opens the atlas in `bytes`. ""
  ///   - openRemote {size}: opens an atlas of that many bytes on a server; fails until "give" has brought
  ///   what
  ///     "wanted" names. ""
  ///   - wanted: the ranges that calls have missed since: [[offset, bytes], ...]. After a picture that wanted
  ///     some, give them and draw again.
  ///   - give {offset}: adds `bytes` as a piece of the file. ""
  ///   - info: the document of `splatlas-player info --json`.
  ///   - select {select}: selects by a text (format/content/selection.h). An array of warnings.
  ///   - fit {state}: the camera that shows the selection, or its part in a structure.
  ///   - draw {state}: draws. {camera, missing, ms, warnings}, and with the first picture of a selection
  ///     drawn: [["surface", 0.4, "#c0392b"], ["off"], ...] by structure; the default opacity is null.
  ///     With palette "distinct" also colors: ["#eebb00", ...] by structure.
  ///   - pick {at}: the structure at [x, y] of the latest picture, and its point; or null.
  ///   - light {structure}: where the latest picture shows a structure or its descendants: a string of 0 and
  ///   1
  ///     for every fourth row, with a digit for every fourth column.
  ///   - slice {axis, index}: see PageSlices::slice().
  ///   - labels {glyphs: {letter: width in em}, dpi, background: "#rrggbb", labels: [name, ...]}: names for
  ///     the latest picture, as on a printed page (annotate_picture()); without labels, of what is no ghost.
  ///     {lines: [[x0, y0, x1, y1, width, color, casing, casing color], ...], dots: [[x, y, radius, color,
  ///     casing, casing color], ...], texts: [[text, x, baseline, size, color], ...]}, in pixels, and
  ///     unlabelled: names without room.
  [[nodiscard]] PageAnswer call(std::string_view request, std::vector<std::byte> bytes = {},
                                const RenderControl& control = {});

  /// The latest picture; empty after an error in drawing it.
  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// Gives the latest picture away: "pick", "light" and "labels" know it no more. The next one reuses the
  /// memory of `spare`.
  [[nodiscard]] Frame take_frame(Frame spare) { return std::exchange(frame_, std::move(spare)); }

 private:
  struct Call;

  RendererOptions options_;
  std::shared_ptr<RemoteBytes> remote_;  // of the atlas that is open, or is being opened
  std::optional<Renderer> renderer_;
  std::optional<std::string> selected_;  // text of the selection
  bool is_distinct_ = false;             // it has colors_
  std::vector<Rgb> colors_;              // Atlas::distinct_colors(), once they are wanted
  std::vector<std::string> warnings_;    // about it
  bool is_told_ = true;                  // a picture has told of it
  std::optional<PageSlices> slices_;
  Frame frame_;
  Camera camera_;  // of the frame
};

}  // namespace splatlas
