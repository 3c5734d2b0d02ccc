// Export of masks, and names of their files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/content/atlas_content.h"
#include "format/io/output_file.h"

namespace splatlas {

/// Names of the structures with voxels that have no label: segments, which a label map leaves out.
[[nodiscard]] std::vector<std::string> structures_without_label(const AtlasContent& content);

struct ExportedMasks {
  std::size_t count = 0;
  std::vector<std::string> notes;  ///< one line each: on the ending, on ids that are no safe file names
};

/// Writes one mask (uint8, 1 inside) per structure to a new or empty folder, atomically: ID.nii.gz, or
/// ID.nrrd if NIfTI cannot hold the grid. Groups and external surfaces have no mask. Ids that are unsafe as
/// file names are changed by file_names_of(). Commits `others` once all masks are written.
[[nodiscard]] Result<ExportedMasks> export_masks(const AtlasContent& content,
                                                 const std::filesystem::path& folder,
                                                 std::span<OutputFile> others = {});

/// File names for `names`, in their order: NAME + `ending`, unique ignoring case, the same on every machine.
///
/// A name is kept if it is safe on Linux, macOS and Windows, and in command lines: ASCII letters, digits,
/// "_", "-" and "."; neither "-" nor "." at its start, nor "." at its end; at most kMaxNameCharacters, so
/// that masks build back. Other names change: each run of other characters becomes "_", non-ASCII letters
/// too, because file systems normalise them differently; "_" precedes a bad start; long names are truncated.
/// Kept names have precedence. Names that are taken get "_2",
/// "_3" and so on, in order. Cost: n log n. Thread-safe.
[[nodiscard]] std::vector<std::string> file_names_of(std::span<const std::string> names,
                                                     std::string_view ending);

}  // namespace splatlas
