// Framing of a picture: standard anatomical views, its middle, and planes that cut it open, as text, too.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "format/content/grid.h"
#include "format/result.h"

namespace splatlas {

/// Named after the side of the subject that faces the viewer.
enum class NamedView : std::uint8_t { kAnterior, kPosterior, kLeft, kRight, kSuperior, kInferior };

/// Name and angles of a view.
struct ViewAngles {
  std::string_view name;
  double azimuth_deg, elevation_deg;
};

/// In the order of NamedView. Superior and inferior views have anterior up.
inline constexpr std::array<ViewAngles, 6> kViewAngles{{{"anterior", 0, 0},
                                                        {"posterior", 180, 0},
                                                        {"left", 90, 0},
                                                        {"right", -90, 0},
                                                        {"superior", 180, 90},
                                                        {"inferior", 0, -90}}};

/// Middle of a picture: that of the fit, a point in LPS mm, or a name of the selection language.
using FrameCenter = std::variant<std::monostate, Vec3, std::string>;

/// Parses X,Y,Z, each at most kMaxMm from 0, or takes the name of a structure. None for other points.
[[nodiscard]] std::optional<FrameCenter> parse_center(std::string_view text);

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
