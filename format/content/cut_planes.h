// Planes that cut a picture open.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "format/content/grid.h"
#include "format/result.h"

namespace splatlas {

/// Plane that removes all points p (LPS mm) with normal_lps * p > offset_mm.
struct CutPlane {
  Vec3 normal_lps{0, 0, 1};  ///< of any length above 0
  double offset_mm = 0;      ///< in mm times the length of the normal
  friend bool operator==(const CutPlane&, const CutPlane&) = default;
};

/// Up to six planes. A picture shows the intersection of the half spaces that they keep.
class CutPlanes {
 public:
  static constexpr std::size_t kMax = 6;

  /// kUsage for a number that is not finite, a normal without a length, and a seventh plane.
  [[nodiscard]] Result<void> add(const CutPlane& plane);

  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const CutPlane* begin() const { return planes_.data(); }
  [[nodiscard]] const CutPlane* end() const { return planes_.data() + size_; }
  friend bool operator==(const CutPlanes&, const CutPlanes&) = default;

 private:
  std::array<CutPlane, kMax> planes_{};
  std::size_t size_ = 0;
};

/// Names the forms of parse_cut().
inline constexpr const char* kCutForms =
    "must be SIDE=MM (left, right, anterior, posterior, superior or inferior) or NX,NY,NZ,D, in LPS mm";

/// Parses SIDE=MM or NX,NY,NZ,D. Numbers may be any.
[[nodiscard]] std::optional<CutPlane> parse_cut(std::string_view text);

/// Parses cuts between blanks, as in a scene. kUsage for a text that is none, and as CutPlanes::add().
[[nodiscard]] Result<CutPlanes> parse_cuts(std::string_view text);

}  // namespace splatlas
