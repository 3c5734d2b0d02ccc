// The player behind a page: answers requests as JSON, in WebAssembly as in a server; atlases in pieces.
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
  /// selection. Never throws. splatlas.js has the calls with their requests and answers. A picture does not
  /// stand in the answer: see frame().
  [[nodiscard]] PageAnswer call(std::string_view request, std::vector<std::byte> bytes = {},
                                const RenderControl& control = {});

  /// The latest picture; empty after an error in drawing it.
  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// Gives the latest picture away from "pick", "light" and "labels". The next one reuses `spare`.
  [[nodiscard]] Frame take_frame(Frame spare) { return std::exchange(frame_, std::move(spare)); }
  void rest() {
    if (renderer_) renderer_->rest();
  }

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
  double told_ms_ = 0;                   // of RenderStats::select_ms, by pictures so far
  std::optional<PageSlices> slices_;
  Frame frame_;
  Camera camera_;  // of the frame
};

}  // namespace splatlas
