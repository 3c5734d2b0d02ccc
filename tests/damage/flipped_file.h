// Damaged copies of an atlas, opened and drawn: an error must accompany every changed picture.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "player/frame/render_overrides.h"
#include "player/render_frame.h"
#include "tests/format/atlas_surgery.h"

namespace splatlas {

/// Outcome of opening and drawing a damaged file.
enum class Outcome : std::uint8_t {
  kRefused,   ///< opening failed
  kNothing,   ///< an error: nothing of the selection can be drawn
  kRest,      ///< exactly the picture of the undamaged parts, with the missing ones listed
  kUnharmed,  ///< the correct picture: the damage lies elsewhere
  kWrong,     ///< anything else
};

/// Damages a valid file and draws the damaged structure. Structures must not overlap: no selection could
/// otherwise name the undamaged rest.
class FlippedFiles {
 public:
  /// Throws std::runtime_error when the file is invalid.
  explicit FlippedFiles(Bytes good);

  [[nodiscard]] std::size_t bytes() const { return good_.size(); }
  /// Flips bits of one byte, opens the file and draws the structure of the damaged chunk, at random together
  /// with another one.
  [[nodiscard]] Outcome flip(std::size_t byte, std::uint8_t mask, std::mt19937& random);
  /// Opens the file truncated to `length` bytes, fewer than it has.
  [[nodiscard]] Outcome truncate(std::size_t length);
  /// The fault of the latest file, or the message about its damage.
  [[nodiscard]] const std::string& remark() const { return remark_; }

 private:
  struct Drawing {
    Selection selection;
    RenderOptions options;
    RenderOverrides overrides = {};
  };
  [[nodiscard]] std::optional<Drawing> drawing_at(std::size_t byte, std::mt19937& random) const;
  [[nodiscard]] std::optional<StructureIndex> structure_at(const SectionLayout& section, std::size_t chunk,
                                                           std::mt19937& random) const;
  [[nodiscard]] Outcome draw(const std::shared_ptr<const Atlas>& damaged, const Drawing& drawing);
  [[nodiscard]] Outcome wrong(std::string remark);

  const Bytes good_;
  const Directory directory_;
  const FileLayout layout_;
  Renderer good_renderer_;
  std::string remark_;
};

}  // namespace splatlas
