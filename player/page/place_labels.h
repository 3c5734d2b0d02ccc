// Boundary labelling: names in two columns, with straight leader lines that do not cross.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "player/page/annotation.h"
#include "player/picture.h"

namespace splatlas {

/// Summed-area table (Crow 1984) of the cells of a picture that show structures: O(1) for any box. Cells have
/// a few pixels, so a box counts as covered up to one cell before it touches a structure.
class FreeSpace {
 public:
  /// Of a picture without structures. O(cells).
  explicit FreeSpace(const PictureSize& size);
  /// Pixels above this alpha show structures; those above 1/512 may change an 8-bit picture. O(pixels).
  explicit FreeSpace(const Picture& picture, float alpha = 1.0f / 512);

  /// True if no pixel of the box shows a structure. Only the part inside the picture counts.
  [[nodiscard]] bool is_free(const PageBox& box) const;
  /// Bounding box of all structures; none for an empty picture.
  [[nodiscard]] std::optional<PageBox> content() const { return content_; }

 private:
  int cell_, columns_, rows_;
  PictureSize corners_;              // of the cells
  std::vector<std::uint32_t> sums_;  // [corner]
  std::optional<PageBox> content_;
};

struct Label {
  std::vector<std::string> lines;  ///< of text, broken by balanced_lines()
  double width = 0, height = 0;    ///< of the text, in pixels
  PagePoint anchor;                ///< end of the leader
  double weight = 0;               ///< labels of small weight are left out first
};

/// Region and distances of labels, in pixels.
struct LabelSpace {
  PageBox region;                  ///< all labels lie inside it
  double column_gap = 0;           ///< between the structures and the columns
  double row_gap = 0;              ///< between two labels
  double leader_gap = 0;           ///< between a label and its leader
  double dot_clearance = 0;        ///< from an anchor to the leaders of other labels
  std::vector<PageBox> obstacles;  ///< boxes that labels and leaders avoid
};

struct PlacedLabel {
  std::size_t label = 0;  ///< index
  PageBox box;            ///< of the text
  bool is_left = false;   ///< in the left column, with text aligned to the right
  PagePoint port;         ///< start of the leader; its end is the anchor
};

/// Places labels in a column on either side of the structures (boundary labelling: Bekos et al. 2007). Labels
/// keep the order of their anchors where leaders allow it, and move as little as possible. Of the result:
///   - no two leaders intersect, and none comes within `dot_clearance` of another anchor
///   - no label covers another one, a leader, an obstacle or a pixel of a structure
///   - all labels lie in the region
/// Labels that would break a rule move into gaps, in the order of their weights, or are left out. O(labels^2
/// * positions) for each exchange of two labels.
[[nodiscard]] std::vector<PlacedLabel> place_labels(const std::vector<Label>& labels, const LabelSpace& space,
                                                    const FreeSpace& free_space);

/// True if the segments a-b and c-d have a common point.
[[nodiscard]] bool segments_meet(PagePoint a, PagePoint b, PagePoint c, PagePoint d);
[[nodiscard]] bool segment_meets(PagePoint a, PagePoint b, const PageBox& box);
[[nodiscard]] double distance_to_segment(PagePoint point, PagePoint a, PagePoint b);

}  // namespace splatlas
