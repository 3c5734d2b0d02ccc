// Warp kernels (hot loop).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace splatlas {

/// Sample positions on a line in the sheet: the first one and the step, in sheet pixels as 32.32 fixed point.
/// Steps are shorter than 4 sheet pixels.
struct WarpWalk {
  const float* pixels = nullptr;  ///< the sheet's border pixel (-1, -1)
  std::int64_t stride = 0;        ///< row stride in pixels
  int channels = 4;               ///< 4: red, green, blue, opacity; 2: white, opacity
  std::array<float, 3> color{};   ///< factor of white
  float skew = 0;                 ///< SheetWindow::skew
  std::int64_t x = 0, y = 0;      ///< relative to `pixels`; not negative
  std::int64_t step_x = 0, step_y = 0;
};

/// Sample positions on a line, inside or outside the sheet, in sheet pixels.
struct CubicWalk {
  const float* pixels = nullptr;  ///< pixel (0, 0)
  std::int64_t columns = 0, rows = 0;
  std::int64_t stride = 0;       ///< row stride in pixels
  int channels = 4;              ///< as in WarpWalk
  std::array<float, 3> color{};  ///< factor of white
  double x = 0, y = 0, step_x = 0, step_y = 0;
};

/// Warp kernels of one instruction set. They write `count` RGBA pixels. Thread-safe.
struct WarpKernels {
  const char* name;
  /// Interpolates four neighbours by sheet_weights(). All positions must be in the sheet or its border.
  void (*warp)(const WarpWalk& walk, std::size_t count, float* out);
  /// Bicubic interpolation (Catmull and Rom 1974) of 4 x 4 sheet pixels; pixels outside the sheet are zero.
  /// Overshoot is clamped: 0 <= colour <= alpha <= 1.
  void (*cubic)(const CubicWalk& walk, std::size_t count, float* out);
};

/// WarpKernels::cubic of the scalar reference kernels and of the fastest ones.
void plain_cubic(const CubicWalk& walk, std::size_t count, float* out);
void best_cubic(const CubicWalk& walk, std::size_t count, float* out);

/// Scalar reference kernels.
[[nodiscard]] WarpKernels scalar_warp();
/// The fastest kernels for this CPU. They agree with the scalar reference kernels to about 1e-6.
[[nodiscard]] WarpKernels best_warp();

}  // namespace splatlas
