// Volume files of ITK's own readers and writers, the reference of ours. ITK's headers are slow to compile.
#pragma once

#include <filesystem>
#include <string>

#include "preprocess/import/images/import_image.h"

namespace splatlas {

/// The file by ITK alone. NIfTI's library replaces NaN and infinities by 0. Throws itk::ExceptionObject.
[[nodiscard]] Image read_by_itk(const std::filesystem::path& path);

/// Writes a NIfTI file. Throws itk::ExceptionObject.
void write_by_itk(const Image& image, const std::string& path);

}  // namespace splatlas
