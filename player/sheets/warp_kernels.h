// HOT LOOP: the warp's inner loop, chosen once per frame for the machine at hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace splatlas {

/// A straight walk over a sheet: where the first pixel looks and how far it is to the next, in sheet pixels,
/// as 32.32 fixed point. Steps are shorter than 4 sheet pixels.
struct WarpWalk {
  const float* pixels = nullptr;  ///< the sheet's border pixel (-1, -1)
  std::int64_t stride = 0;        ///< pixels from one row to the next
  int channels = 4;               ///< 4: red, green, blue, opacity; 2: white, opacity
  std::array<float, 3> color{};   ///< what white stands for
  float skew = 0;                 ///< see SheetWindow
  std::int64_t x = 0, y = 0;      ///< from that pixel on: not negative
  std::int64_t step_x = 0, step_y = 0;
};

/// A straight walk over a sheet, or beside it, in sheet pixels.
struct CubicWalk {
  const float* pixels = nullptr;  ///< pixel (0, 0)
  std::int64_t columns = 0, rows = 0;
  std::int64_t stride = 0;       ///< pixels from one row to the next
  int channels = 4;              ///< as those of WarpWalk
  std::array<float, 3> color{};  ///< what white stands for
  double x = 0, y = 0, step_x = 0, step_y = 0;
};

struct WarpKernels {
  const char* name;
  /// Samples at `count` places, to `count` pixels of 4 floats: the four neighbours, with bilinear weights,
  /// and `skew` taken from two and given to the two on the diagonal. Every place must have its four
  /// neighbours in the sheet.
  void (*warp)(const WarpWalk& walk, std::size_t count, float* out);
  /// Samples at `count` places by Catmull and Rom's cubic (1974) over 4 x 4 sheet pixels; nothing is outside
  /// the sheet. What overshoots at cliffs is cut off: 0 <= colour <= alpha <= 1.
  void (*cubic)(const CubicWalk& walk, std::size_t count, float* out);
};

/// WarpKernels::cubic of the scalar twin, and of the best one.
void plain_cubic(const CubicWalk& walk, std::size_t count, float* out);
void best_cubic(const CubicWalk& walk, std::size_t count, float* out);

[[nodiscard]] const WarpKernels& scalar_warp();
/// Agrees with the scalar twin to about 1e-6.
[[nodiscard]] const WarpKernels& best_warp();

}  // namespace splatlas
