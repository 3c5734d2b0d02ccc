// Reads a PLY file once before VTK does, whose reader believes every count and every name.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Refuses a header with lines that PLY has not, vertices without x, y and z, faces without vertex_indices,
/// lines and lists longer than VTK's buffers, and files that end before their elements do. Every error is
/// kFailed. Cost: the file is read once. Whether corners exist is for whoever reads the triangles to check.
[[nodiscard]] Result<void> check_ply_file(const std::filesystem::path& path);

}  // namespace splatlas
