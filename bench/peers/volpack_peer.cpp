#include "bench/peers/volpack_peer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <volpack.h>

#include "format/content/unit_vector.h"
#include "format/result_macros.h"
#include "player/render/transfer/shading.h"

namespace splatlas {
namespace {

using reference::GreyAppearance;
using reference::MaskedVolume;

constexpr double kMaxRayOpacity = 0.999;
/// Skips only fully transparent voxels.
constexpr double kMinVoxelOpacity = 0;

/// Voxel layout of VolPack: the two-byte field of the colour look-up comes first.
struct RawVoxel {
  std::uint16_t color_index;  // code of the normal, or kUnlitIndex
  std::uint8_t grey;
};
/// Colour look-up of voxels without a normal, behind those of all normals.
constexpr std::uint16_t kUnlitIndex = VP_NORM_MAX + 1;
/// VolPack weights the colours of materials, if there are several. The second one is black.
constexpr int kMaterials = 2;
constexpr int kColorField = 0;
constexpr int kGreyField = 1;

struct DestroyContext {
  void operator()(vpContext* context) const { vpDestroyContext(context); }
};

Result<void> check(vpContext* context, vpResult code, const char* what) {
  if (code == VP_OK) return {};
  return fail(ErrorCode::kFailed,
              fmt::format("VolPack: {}: {}", what, vpGetErrorString(vpGetError(context))));
}

/// VolPack's code of every packed normal, as a direction in LPS.
const std::vector<std::uint16_t>& codes_of_normals() {
  static const std::vector<std::uint16_t> kCodes = [] {
    std::vector<std::uint16_t> codes;
    for (std::uint32_t n = 0; n <= std::numeric_limits<PackedNormal>::max(); ++n) {
      const std::array<float, 3> normal = unpack_normal(static_cast<PackedNormal>(n));
      codes.push_back(static_cast<std::uint16_t>(vpNormalIndex(
          static_cast<double>(normal[0]), static_cast<double>(normal[1]), static_cast<double>(normal[2]))));
    }
    return codes;
  }();
  return kCodes;
}

/// The direction of every code of VolPack.
const std::vector<std::array<float, 3>>& normals_of_codes() {
  static const std::vector<std::array<float, 3>> kNormals = [] {
    std::vector<std::array<float, 3>> normals;
    for (int code = 0; code <= VP_NORM_MAX; ++code) {
      Vec3 n{};
      vpNormal(code, n.data(), &n[1], &n[2]);
      normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    }
    return normals;
  }();
  return kNormals;
}

/// VolPack object coordinates to eye coordinates in mm. The longest side of the volume spans -1/2 to 1/2. The
/// first picture row is at the bottom of the window, so that the second eye axis points down.
void eye_from_object(const Grid& grid, const ParallelView& view, vpMatrix4 matrix) {
  const Affine to_lps = index_to_lps_mm(grid);
  const Vec3 down_lps{-view.up_lps[0], -view.up_lps[1], -view.up_lps[2]};
  const std::array<const Vec3*, 3> rows{&view.right_lps, &down_lps, &view.forward_lps};
  const auto longest = static_cast<double>(*std::max_element(grid.size.begin(), grid.size.end()));
  vpIdentity4(matrix);
  Vec3 middle_voxel{};  // origin of the object coordinates; voxels span from their index to the next
  for (std::size_t a = 0; a < 3; ++a) middle_voxel[a] = 0.5 * static_cast<double>(grid.size[a]);
  const Vec3 middle = to_lps.apply(middle_voxel);
  for (std::size_t row = 0; row < 3; ++row) {
    const Vec3& direction = *rows[row];
    if (row < 2) matrix[row][3] = -0.5 * view.mm_per_pixel;  // VolPack samples pixels at their corners
    for (std::size_t a = 0; a < 3; ++a) {
      Vec3 step{0, 0, 0};
      step[a] = longest;
      const Vec3 step_mm = to_lps.apply_linear(step);
      matrix[row][a] = direction[0] * step_mm[0] + direction[1] * step_mm[1] + direction[2] * step_mm[2];
      matrix[row][3] += direction[a] * (middle[a] - view.center_lps_mm[a]);
    }
  }
}

}  // namespace

struct VolpackPeer::Impl {
  Grid grid;
  std::unique_ptr<vpContext, DestroyContext> context{vpCreateContext()};
  std::array<float, 256> opacity{};
  std::array<std::array<float, 3>, 256> color{};                          // unlit
  std::vector<std::array<std::array<float, 3>, kMaterials>> shade_table;  // by code of the normal; then unlit
  std::array<std::array<float, kMaterials>, 256> weights{};               // by grey value
  std::array<float, 3> hue{};
  std::optional<ParallelView> shaded_for;
  PictureSize size;
  std::vector<std::uint8_t> rgba;

  void set_appearance(const GreyAppearance& appearance) {
    const Vec3& spacing = grid.spacing_mm;
    for (std::size_t grey = 0; grey < opacity.size(); ++grey) {
      const GreyAppearance::Knot knot = appearance.at(static_cast<double>(grey));
      opacity[grey] = static_cast<float>(-std::expm1(-knot.extinction_per_mm * spacing[0]));
      for (std::size_t c = 0; c < 3; ++c) color[grey][c] = static_cast<float>(255 * knot.color[c]);
    }
  }

  /// Splits colours into a hue and the weight of a grey value.
  void set_hue() {
    hue = *std::max_element(color.begin(), color.end());
    const auto c = static_cast<std::size_t>(std::max_element(hue.begin(), hue.end()) - hue.begin());
    for (std::size_t grey = 0; grey < color.size(); ++grey)
      weights[grey] = {hue[c] > 0 ? color[grey][c] / hue[c] : 0, 0};
  }

  /// Hybrid shading for a view, with the table filled by the caller, as VolPack's guide describes.
  void fill_shade_table(const ParallelView& view) {
    if (shaded_for && have_same_lighting(*shaded_for, view)) return;
    shaded_for = view;
    const Lighting lighting(view);
    const std::vector<std::array<float, 3>>& normals = normals_of_codes();
    for (std::size_t code = 0; code < normals.size(); ++code) {
      std::array<float, 3> normal = normals[code];  // or its mirror image, as in Lighting::table()
      const double away = std::max(0.0, dot({normal[0], normal[1], normal[2]}, view.forward_lps));
      for (std::size_t a = 0; a < 3; ++a) normal[a] -= static_cast<float>(2 * away * view.forward_lps[a]);
      const float factor = lighting.on_surface(normal).diffuse;
      for (std::size_t c = 0; c < 3; ++c) shade_table[code][0][c] = factor * hue[c];
    }
  }

  Result<void> set_shader() {
    vpContext* vp = context.get();
    set_hue();
    shade_table.assign(kUnlitIndex + 1, {});
    shade_table[kUnlitIndex][0] = hue;
    const std::size_t table_bytes = shade_table.size() * sizeof(shade_table.front());
    return check(
        vp,
        vpSetLookupShader(vp, 3, kMaterials, kColorField, shade_table.front().front().data(),
                          static_cast<int>(table_bytes), kGreyField, weights.front().data(), sizeof(weights)),
        "shader");
  }

  Result<void> set_up() {
    vpContext* vp = context.get();
    const auto [nx, ny, nz] = grid.size;
    SPLATLAS_RETURN_IF_ERROR(
        check(vp, vpSetVolumeSize(vp, static_cast<int>(nx), static_cast<int>(ny), static_cast<int>(nz)),
              "volume size"));
    constexpr int kShadeFields = 2;  // colour, and weight
    SPLATLAS_RETURN_IF_ERROR(
        check(vp, vpSetVoxelSize(vp, sizeof(RawVoxel), 2, kShadeFields, 1), "voxel size"));
    SPLATLAS_RETURN_IF_ERROR(check(
        vp,
        vpSetVoxelField(vp, kColorField, sizeof(std::uint16_t), offsetof(RawVoxel, color_index), kUnlitIndex),
        "field"));
    SPLATLAS_RETURN_IF_ERROR(check(
        vp, vpSetVoxelField(vp, kGreyField, sizeof(std::uint8_t), offsetof(RawVoxel, grey), 255), "field"));
    SPLATLAS_RETURN_IF_ERROR(
        check(vp, vpSetClassifierTable(vp, 0, kGreyField, opacity.data(), sizeof(opacity)), "classifier"));
    SPLATLAS_RETURN_IF_ERROR(set_shader());
    SPLATLAS_RETURN_IF_ERROR(
        check(vp, vpSetd(vp, VP_MIN_VOXEL_OPACITY, kMinVoxelOpacity), "smallest opacity"));
    return check(vp, vpSetd(vp, VP_MAX_RAY_OPACITY, kMaxRayOpacity), "largest opacity");
  }

  Result<void> classify(const MaskedVolume& volume) {
    std::vector<RawVoxel> voxels(volume.greys.size());
    const std::vector<std::uint16_t>& codes = codes_of_normals();
    for (std::size_t n = 0; n < voxels.size(); ++n) {
      const bool is_lit = volume.lit.empty() || volume.lit[n] >= 0.5;  // VolPack knows no shares
      const std::int32_t normal = is_lit ? volume.normals[n] : MaskedVolume::kUnlit;
      voxels[n] = {normal < 0 ? kUnlitIndex : codes[static_cast<std::size_t>(normal)], volume.greys[n]};
    }
    vpContext* vp = context.get();
    const auto voxel_bytes = static_cast<int>(sizeof(RawVoxel));
    const int row_bytes = voxel_bytes * static_cast<int>(grid.size[0]);
    const int slice_bytes = row_bytes * static_cast<int>(grid.size[1]);
    SPLATLAS_RETURN_IF_ERROR(
        check(vp,
              vpSetRawVoxels(vp, voxels.data(), slice_bytes * static_cast<int>(grid.size[2]), voxel_bytes,
                             row_bytes, slice_bytes),
              "voxels"));
    SPLATLAS_RETURN_IF_ERROR(check(vp, vpClassifyVolume(vp), "classification"));
    return check(vp, vpSetRawVoxels(vp, nullptr, 0, 0, 0, 0), "voxels");
  }
};

Result<VolpackPeer> VolpackPeer::classify(const MaskedVolume& volume, const GreyAppearance& appearance) {
  auto impl = std::make_shared<Impl>();
  impl->grid = volume.grid;
  impl->set_appearance(appearance);
  SPLATLAS_RETURN_IF_ERROR(impl->set_up());
  SPLATLAS_RETURN_IF_ERROR(impl->classify(volume));
  return VolpackPeer(std::move(impl));
}

Result<void> VolpackPeer::render(const ParallelView& view) {
  vpContext* vp = impl_->context.get();
  const auto [width, height] = view.size;
  impl_->size = view.size;
  impl_->fill_shade_table(view);
  impl_->rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  SPLATLAS_RETURN_IF_ERROR(
      check(vp, vpSetImage(vp, impl_->rgba.data(), width, height, 4 * width, VP_RGBA), "picture"));
  vpMatrix4 matrix;
  eye_from_object(impl_->grid, view, matrix);
  vpCurrentMatrix(vp, VP_PROJECT);
  vpIdentityMatrix(vp);
  const double half_width = 0.5 * view.mm_per_pixel * width;
  const double half_height = 0.5 * view.mm_per_pixel * height;
  SPLATLAS_RETURN_IF_ERROR(
      check(vp, vpWindow(vp, VP_PARALLEL, -half_width, half_width, -half_height, half_height, -1e4, 1e4),
            "window"));
  vpCurrentMatrix(vp, VP_MODEL);
  vpSetMatrix(vp, matrix);
  return check(vp, vpRenderClassifiedVolume(vp), "rendering");
}

Picture VolpackPeer::picture() const {
  Picture picture{impl_->size, {}};
  picture.rgba.reserve(impl_->rgba.size());
  for (const std::uint8_t value : impl_->rgba) picture.rgba.push_back(static_cast<float>(value) / 255.0f);
  return picture;
}

}  // namespace splatlas
