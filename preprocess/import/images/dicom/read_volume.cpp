#include "preprocess/import/images/dicom/read_volume.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/decode/decode_frame.h"
#include "preprocess/import/images/dicom/slice_positions.h"

namespace splatlas {
namespace {

template <typename T>
bool holds(double min, double max) {
  return min >= static_cast<double>(std::numeric_limits<T>::min()) &&
         max <= static_cast<double>(std::numeric_limits<T>::max());
}

bool is_whole(const DicomFrame& frame) {
  const double rounded = std::trunc(frame.intercept);
  return !(frame.slope < 1 || frame.slope > 1) && !(rounded < frame.intercept || rounded > frame.intercept);
}

/// The type for all values that the bits of the frames can have: kInt32 if only the pixels can tell.
VoxelType widest_type(const SlicedStack& stack) {
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const auto& slice : stack.slices) {
    const DicomFrame& frame = *slice.front();
    if (!is_whole(frame)) return VoxelType::kFloat32;
    min = std::min(min, static_cast<double>(frame.pixels.min()) + frame.intercept);
    max = std::max(max, static_cast<double>(frame.pixels.max()) + frame.intercept);
  }
  if (holds<std::int16_t>(min, max)) return VoxelType::kInt16;
  if (holds<std::uint16_t>(min, max)) return VoxelType::kUInt16;
  return holds<std::int32_t>(min, max) ? VoxelType::kInt32 : VoxelType::kFloat32;
}

/// Makes a buffer of another type. In place: no value of T is longer than 32 bits.
template <typename T>
void convert(VoxelBuffer& voxels, VoxelType type) {
  const std::size_t count = voxels.bytes.size() / sizeof(std::int32_t);
  for (std::size_t v = 0; v < count; ++v) {
    std::int32_t value = 0;
    std::memcpy(&value, &voxels.bytes[v * sizeof(value)], sizeof(value));
    const auto converted = static_cast<T>(value);
    std::memcpy(&voxels.bytes[v * sizeof(T)], &converted, sizeof(T));
  }
  voxels.bytes.resize(count * sizeof(T));
  voxels.bytes.shrink_to_fit();
  voxels.type = type;
}

void narrow(VoxelBuffer& voxels) {
  const std::int32_t* const values = voxels.as<std::int32_t>();
  const auto [least, greatest] = std::minmax_element(values, values + voxels.bytes.size() / sizeof(*values));
  const double min = *least, max = *greatest;
  if (holds<std::int16_t>(min, max)) return convert<std::int16_t>(voxels, VoxelType::kInt16);
  if (holds<std::uint16_t>(min, max)) return convert<std::uint16_t>(voxels, VoxelType::kUInt16);
  convert<float>(voxels, VoxelType::kFloat32);
}

void note_kinds(const SlicedStack& stack, Notes& notes) {
  static const NoteKind kDuplicates{"duplicate-slices", "slice repeats another's position and is ignored",
                                    "slices repeat others' positions and are ignored", true};
  static const NoteKind kMosaic{"mosaic",
                                "image is a mosaic of slices, which stay side by side; use dcm2niix",
                                "images are mosaics of slices, which stay side by side; use dcm2niix", true};
  static const NoteKind kInverted{"inverted-image", "volume is meant to be shown inverted (MONOCHROME1)",
                                  "volumes are meant to be shown inverted (MONOCHROME1)"};
  for (const auto& slice : stack.slices) {
    for (std::size_t n = 1; n < slice.size(); ++n) notes.add(kDuplicates, position_text(slice[n]->position));
  }
  const DicomFrame& first = *stack.slices.front().front();
  if (first.is_mosaic) notes.add(kMosaic, position_text(first.position));
  if (first.is_inverted) notes.add(kInverted, first.modality);
}

}  // namespace

Result<VoxelBuffer> read_volume(const SlicedStack& stack, Notes& notes) {
  VoxelBuffer voxels{widest_type(stack), {}};
  const auto plane = static_cast<std::size_t>(stack.grid.size[0] * stack.grid.size[1]);
  voxels.bytes.resize(plane * stack.slices.size() * bytes_of(voxels.type));
  FrameDecoder decoder;
  for (std::size_t k = 0; k < stack.slices.size(); ++k) {
    const DicomFrame& frame = *stack.slices[k].front();
    SPLATLAS_ASSIGN_OR_RETURN(const auto stored, decoder.decode(frame));
    visit_voxel_type(voxels.type, [&]<typename T>(T) {
      T* const values = voxels.as<T>() + k * plane;
      for (std::size_t v = 0; v < plane; ++v)
        values[v] = static_cast<T>(static_cast<double>(stored[v]) * frame.slope + frame.intercept);
    });
  }
  if (voxels.type == VoxelType::kInt32) narrow(voxels);
  note_kinds(stack, notes);
  return voxels;
}

}  // namespace splatlas
