// Coded bytes of the frames of a DICOM file.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

namespace splatlas {

/// The coded bytes of frame `index`. A frame may have several fragments, and often there is no table of
/// frames: then the signatures of JPEG and JPEG 2000 tell where frames start. None if that is unclear.
/// Cost: reads the fragments of the frame, and the starts of those before it.
[[nodiscard]] std::optional<std::vector<std::byte>> frame_fragments(DcmPixelData& pixels,
                                                                    E_TransferSyntax syntax,
                                                                    std::uint32_t frames,
                                                                    std::uint32_t index);

}  // namespace splatlas
