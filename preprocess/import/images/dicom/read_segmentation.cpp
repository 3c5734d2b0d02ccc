#include "preprocess/import/images/dicom/read_segmentation.h"

#include <algorithm>
#include <cstring>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/decode/decode_frame.h"
#include "preprocess/import/images/dicom/read_segments.h"
#include "preprocess/import/images/dicom/slice_positions.h"
#include "preprocess/import/import_error.h"

namespace splatlas {
namespace {

/// The voxels of one segment in one slice.
struct SliceMask {
  std::size_t slice = 0;
  std::vector<bool> voxels;
};

/// Layers of segment numbers of type T.
template <typename T>
class Layers {
 public:
  Layers(const SlicedStack& stack, const SegmentList& list, const std::filesystem::path& path)
      : stack_(stack),
        list_(list),
        path_(path),
        plane_(static_cast<std::size_t>(stack.grid.size[0] * stack.grid.size[1])) {
    add_layer();
  }

  Result<void> add_masks(std::vector<SourceSegment>& segments) {
    SPLATLAS_RETURN_IF_ERROR(check_numbers());
    for (SourceSegment& segment : segments) {
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<SliceMask> masks, masks_of(segment.value));
      std::size_t layer = 0;
      while (layer < layers_.size() && overlaps(masks, layers_[layer])) ++layer;
      if (layer == layers_.size()) add_layer();
      segment.layer = layer;
      write(masks, static_cast<T>(segment.value), layers_[layer]);
    }
    return {};
  }

  Result<void> add_labels() {
    for (std::size_t k = 0; k < stack_.slices.size(); ++k) {
      if (stack_.slices[k].empty()) continue;
      SPLATLAS_ASSIGN_OR_RETURN(const auto values, decoder_.decode(*stack_.slices[k].front()));
      for (std::size_t v = 0; v < plane_; ++v) {
        if (values[v] != list_.background) layers_[0][k * plane_ + v] = static_cast<T>(values[v]);
      }
      for (std::size_t n = 1; n < stack_.slices[k].size(); ++n) note_duplicate(*stack_.slices[k][n]);
    }
    return {};
  }

  void hand_over(SourceImage& image, VoxelType type) {
    image.layers = layers_.size();
    image.voxels.type = type;
    image.notes.add(notes_);
    const std::size_t bytes = layers_[0].size() * sizeof(T);
    image.voxels.bytes.resize(bytes * layers_.size());
    for (std::size_t n = 0; n < layers_.size(); ++n)
      std::memcpy(&image.voxels.bytes[n * bytes], layers_[n].data(), bytes);
  }

 private:
  using Layer = std::vector<T>;

  void add_layer() { layers_.emplace_back(plane_ * stack_.slices.size()); }

  void note_duplicate(const DicomFrame& frame) {
    static const NoteKind kDuplicates{"duplicate-slices", "slice repeats another's position and is ignored",
                                      "slices repeat others' positions and are ignored", true};
    notes_.add(kDuplicates, position_text(frame.position));
  }

  /// Each frame must name a segment of the list.
  Result<void> check_numbers() {
    for (const auto& slice : stack_.slices) {
      for (const DicomFrame* frame : slice) {
        if (std::ranges::find(list_.segments, frame->segment, &SourceSegment::value) == list_.segments.end())
          return bad_file(path_, "has a frame of segment {}, which is not in its list", frame->segment);
      }
    }
    return {};
  }

  Result<std::vector<SliceMask>> masks_of(std::int64_t number) {
    std::vector<SliceMask> masks;
    for (std::size_t k = 0; k < stack_.slices.size(); ++k) {
      bool is_first = true;
      for (const DicomFrame* frame : stack_.slices[k]) {
        if (frame->segment != number) continue;
        if (!std::exchange(is_first, false)) {
          note_duplicate(*frame);
          continue;
        }
        SPLATLAS_ASSIGN_OR_RETURN(const auto values, decoder_.decode(*frame));
        const std::int32_t max = list_.kind == SegmentationKind::kFractional ? list_.max_fraction : 1;
        SliceMask mask{k, std::vector<bool>(plane_)};
        for (std::size_t v = 0; v < plane_; ++v) mask.voxels[v] = 2 * values[v] > max;
        masks.push_back(std::move(mask));
      }
    }
    return masks;
  }

  bool overlaps(const std::vector<SliceMask>& masks, const Layer& layer) const {
    return std::ranges::any_of(masks, [&](const SliceMask& mask) {
      const T* const voxels = &layer[mask.slice * plane_];
      for (std::size_t v = 0; v < plane_; ++v) {
        if (mask.voxels[v] && voxels[v] != 0) return true;
      }
      return false;
    });
  }

  void write(const std::vector<SliceMask>& masks, T number, Layer& layer) const {
    for (const SliceMask& mask : masks) {
      for (std::size_t v = 0; v < plane_; ++v) {
        if (mask.voxels[v]) layer[mask.slice * plane_ + v] = number;
      }
    }
  }

  const SlicedStack& stack_;
  const SegmentList& list_;
  const std::filesystem::path& path_;
  std::size_t plane_;
  std::vector<Layer> layers_;
  FrameDecoder decoder_;
  Notes notes_;
};

template <typename T>
Result<void> fill(const SlicedStack& stack, SegmentList& list, const std::filesystem::path& path,
                  VoxelType type, SourceImage& image) {
  Layers<T> layers(stack, list, path);
  image.segments = list.segments;
  if (list.kind == SegmentationKind::kLabelMap) {
    SPLATLAS_RETURN_IF_ERROR(layers.add_labels());
  } else {
    SPLATLAS_RETURN_IF_ERROR(layers.add_masks(image.segments));
  }
  layers.hand_over(image, type);
  return {};
}

}  // namespace

Result<SourceImage> read_segmentation(SlicedStack stack, const std::filesystem::path& path) {
  SPLATLAS_ASSIGN_OR_RETURN(SegmentList list, read_segments(path));
  const DicomFrame& frame =
      **std::ranges::find_if(stack.slices, [](const auto& s) { return !s.empty(); })->begin();
  const bool is_label_map = list.kind == SegmentationKind::kLabelMap;
  constexpr int kShort = 16;
  if (frame.pixels.is_signed || frame.pixels.bits_stored > kShort)
    return bad_file(path, "is a segmentation with signed numbers or more than 16 bits, which cannot be");
  SourceImage image;
  image.grid = stack.grid;
  image.is_segmentation = true;
  image.notes = std::move(stack.notes);
  image.notes.add(list.notes);
  constexpr int kByte = 8;
  const bool is_short =
      list.segments.back().value > 255 || (is_label_map && frame.pixels.bits_stored > kByte);
  if (is_short) {
    SPLATLAS_RETURN_IF_ERROR(fill<std::uint16_t>(stack, list, path, VoxelType::kUInt16, image));
  } else {
    SPLATLAS_RETURN_IF_ERROR(fill<std::uint8_t>(stack, list, path, VoxelType::kUInt8, image));
  }
  return image;
}

}  // namespace splatlas
