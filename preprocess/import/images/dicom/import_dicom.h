// Import of DICOM series, multi-frame images and segmentations.
#pragma once

#include <filesystem>

#include "format/result.h"
#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// True for a file that begins as DICOM, with a preamble or without, whatever its ending, and for a folder
/// that holds such a file at most 16 levels below. Cost: opens files until the first hit, at most 4096.
/// Thread-safe.
[[nodiscard]] bool is_dicom(const std::filesystem::path& file_or_folder);

/// True for a file of contours (RTSTRUCT), which has no grid of its own, and for a folder that holds one.
/// Cost: as is_dicom().
[[nodiscard]] bool is_contours(const std::filesystem::path& file_or_folder);

/// Imports the only volume or segmentation of a file or folder, or the one that `options.series` names. Of a
/// folder with both, `options.labels` takes the segmentation or the contours, and else the volume is taken.
/// Grid in LPS mm; a tilted stack has a sheared grid. Missing slices and uneven steps are interpolated, with
/// a warning. Values as the files scale them: int16, uint16 or float32. kUsage if there are several series
/// and none, or no known one, is named; the message lists them. kFailed for damaged or cut files, and images
/// without geometry; see read_frames.h, stack_frames.h and read_segmentation.h. Nothing of a header is passed
/// on but geometry, modality, segment labels, colours and codes. Cost: opens each file once or twice; memory
/// for the volume. One thread at a time. The libraries below may abort or hang on hostile files: call it in a
/// child with limits.
[[nodiscard]] Result<SourceImage> import_dicom(const std::filesystem::path& file_or_folder,
                                               const ImageOptions& options);

/// Loads the dictionary of attributes, which implicit files need, in about 10 ms. Call it before children are
/// forked: it spares each of them the time. One thread at a time.
void load_dicom_dictionary();

}  // namespace splatlas
