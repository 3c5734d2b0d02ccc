// Values of attributes in DICOM data sets and in items of sequences, without DCMTK's traps.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include "format/result.h"

namespace splatlas {

/// Turns DCMTK's messages off: they quote headers, which hold names of patients. Lets it look up the types of
/// attributes that a program wrote as unknown. Cheap after the first call.
void prepare_dcmtk();

/// Bytes of a file that tell whether it is of DICOM.
inline constexpr std::size_t kHeadBytes = 1024;
/// True for a regular file with "DICM" at byte 128, or that begins with its data set, as old exports do.
[[nodiscard]] bool begins_as_dicom(const std::filesystem::path& file);

/// Opens a file up to its pixels, or with them. Long values stay in the file until they are asked for.
/// kFailed for damaged and cut files.
enum class DicomPart { kHeader, kWhole };
[[nodiscard]] Result<std::unique_ptr<DcmFileFormat>> open_dicom(const std::filesystem::path& file,
                                                                DicomPart part);

/// The n-th value of an attribute as a number. None if it is missing, empty, not a number or not finite.
[[nodiscard]] std::optional<double> number_in(DcmItem& item, const DcmTagKey& tag, unsigned long n = 0);
[[nodiscard]] std::optional<std::int64_t> integer_in(DcmItem& item, const DcmTagKey& tag);
/// All values of an attribute with their separators, trimmed; empty if it is missing.
[[nodiscard]] std::string text_in(DcmItem& item, const DcmTagKey& tag);

/// The items of a sequence, in order; empty if it is missing. Linear: DCMTK keeps them in a list.
[[nodiscard]] std::vector<DcmItem*> items_in(DcmItem& item, const DcmTagKey& sequence);
/// The first item of a sequence, or null.
[[nodiscard]] DcmItem* first_item(DcmItem& item, const DcmTagKey& sequence);

/// The first N values of an attribute. None if one is missing.
template <std::size_t N>
[[nodiscard]] std::optional<std::array<double, N>> numbers_in(DcmItem& item, const DcmTagKey& tag) {
  std::array<double, N> numbers{};
  for (std::size_t n = 0; n < N; ++n) {
    const std::optional<double> number = number_in(item, tag, n);
    if (!number) return std::nullopt;
    numbers[n] = *number;
  }
  return numbers;
}

}  // namespace splatlas
