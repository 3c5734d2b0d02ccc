// Readers of image files.
#pragma once

#include <filesystem>
#include <optional>

#include "format/content/grid.h"
#include "format/result.h"
#include "preprocess/import/images/pixels/source_image.h"

namespace splatlas {

/// Reads .nii, .nii.gz, and pairs of .hdr and .img (or .img.gz), by either name. Every volume beyond the
/// third axis is a layer. Applies scl_slope and scl_inter, with floats as result; doubles stay doubles. Names
/// of labels come from the header's extensions. kFailed for:
///   - files of another kind, and files whose ending contradicts their compression,
///   - geometry that cannot be (nifti_grid()), unsupported types, 64-bit integers beyond 32 bits,
///   - fewer bytes than the header promises, and damaged compression.
/// Cost: one pass. Thread-safe.
[[nodiscard]] Result<SourceImage> read_nifti(const std::filesystem::path& path,
                                             const ImageOptions& options = {});

/// The file beside one of a pair; the path itself for other files.
[[nodiscard]] std::filesystem::path other_of_pair(const std::filesystem::path& path);

/// Reads .nrrd, .nhdr and .seg.nrrd: layers from lists, vectors and a fourth axis; segments of 3D Slicer. A
/// warning tells if the axes have no anatomical meaning, and are read as LPS. kFailed, in one line, for files
/// that check_nrrd_file() or ITK reject. Cost: one pass.
[[nodiscard]] Result<SourceImage> read_nrrd(const std::filesystem::path& path,
                                            const ImageOptions& options = {});
/// Reads .mha and .mhd: layers from channels and a fourth axis.
[[nodiscard]] Result<SourceImage> read_meta_image(const std::filesystem::path& path,
                                                  const ImageOptions& options = {});

/// Reads .mgh, .mgz and .mgh.gz (FreeSurfer wiki, MghFormat): scanner RAS, frames as layers. A warning tells
/// if the file has no orientation; FreeSurfer's own (1 mm, coronal) is taken then. kFailed for values of
/// surfaces (N x 1 x 1), axes that are no axes, unsupported types, and damaged files. One pass. Thread-safe.
[[nodiscard]] Result<SourceImage> read_mgh(const std::filesystem::path& path,
                                           const ImageOptions& options = {});

/// True for a file that begins as DICOM, with a preamble or without, whatever its ending, and for a folder
/// that holds such a file. Cost: lists the folder, opens up to 4096 files until a hit. Thread-safe.
[[nodiscard]] bool is_dicom(const std::filesystem::path& file_or_folder);

/// True for a file of contours (RTSTRUCT), without a grid, or a folder that holds one. Cost: as is_dicom().
[[nodiscard]] bool is_contours(const std::filesystem::path& file_or_folder);

/// Imports the only volume or segmentation of a file or folder, or the one that `options.series` names. Of a
/// folder with both, `options.labels` takes the segmentation or the contours, and else the volume is taken.
/// Grid in LPS mm; a tilted stack has a sheared grid. Missing slices and uneven steps are interpolated, with
/// a warning. Values as the files scale them: int16, uint16 or float32. kUsage if there are several series
/// and none, or no known one, is named; the message lists them. kFailed for damaged or cut files, and images
/// without geometry; see dicom_frame.h and read_segmentation.h. Nothing of a header is passed
/// on but geometry, modality, segment labels, colours and codes. Cost: opens each file once or twice; memory
/// for the volume. One thread at a time. The libraries below may abort or hang on hostile files: call it in a
/// child with limits.
[[nodiscard]] Result<SourceImage> import_dicom(const std::filesystem::path& file_or_folder,
                                               const ImageOptions& options);

/// Loads the dictionary of attributes, which implicit files need, in about 10 ms. Call it before children are
/// forked: it spares each of them the time. One thread at a time.
void load_dicom_dictionary();

/// True for .tif, .tiff and .png.
[[nodiscard]] bool is_picture(const std::filesystem::path& path);

/// Reads one picture, a TIFF file of several pages, or all pictures of a folder, one slice each. Files are in
/// the order of the numbers in their names: slice_2 stands before slice_10. Pictures hold no positions:
/// kUsage without `options.spacing_mm`, but in a BrainGlobe folder, which has its own.
/// A warning tells that x runs to the left, y to the back, and slices upwards. kFailed for colours, palettes,
/// and pictures of several sizes or types.
[[nodiscard]] Result<SourceImage> read_pictures(const std::filesystem::path& file_or_folder,
                                                const ImageOptions& options);

/// True for a folder with metadata.json, annotation.tiff and structures.json (BrainGlobe, version 1).
[[nodiscard]] bool is_brainglobe_folder(const std::filesystem::path& path);

/// Spacing and direction of the axes of a stack of pictures: columns, rows, pages.
struct PictureFrame {
  Vec3 spacing_mm{};
  Matrix3 direction_lps{};
};

/// The frame that metadata.json tells for the pictures beside it: resolution in micrometres and orientation,
/// the corner where the axes begin ("asr": pages run to the back, rows downwards, columns to the left).
/// Nothing if the file's folder is no BrainGlobe folder. kFailed for metadata that cannot be.
[[nodiscard]] Result<std::optional<PictureFrame>> brainglobe_frame(const std::filesystem::path& picture);

}  // namespace splatlas
