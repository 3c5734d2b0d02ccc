// One damaged file after the other, opened and drawn: damage must be told, and no picture may change without
// that.
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

/// What became of a damaged file.
enum class Outcome : std::uint8_t {
  kRefused,   ///< it could not be opened
  kNothing,   ///< nothing of the selection could be drawn: an error
  kRest,      ///< the picture of the rest, which is exactly that, and a word about what is missing
  kUnharmed,  ///< the picture as it should be: the damage is elsewhere
  kWrong,     ///< anything else
};

/// Damages a good file, and draws what lies where the damage is. Its structures must not overlap: what is
/// left of one of them could not be told by a selection.
class FlippedFiles {
 public:
  /// Throws std::runtime_error when the file is not good.
  explicit FlippedFiles(Bytes good);

  [[nodiscard]] std::size_t bytes() const { return good_.size(); }
  /// Changes one byte, opens the file, and draws a structure whose chunk it is, with another one, as chance
  /// will have it.
  [[nodiscard]] Outcome flip(std::size_t byte, std::uint8_t mask, std::mt19937& random);
  /// Opens the first bytes of the file, fewer than all.
  [[nodiscard]] Outcome truncate(std::size_t length);
  /// What was wrong with the latest file; or what was said about it.
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
