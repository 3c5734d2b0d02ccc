// Fuzz input as a file, for readers that take a path.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace splatlas {

/// Writes `bytes` to the file `name` in a folder of this process, which a regular exit removes.
[[nodiscard]] std::filesystem::path write_input_file(const std::string& name,
                                                     std::span<const std::byte> bytes);

}  // namespace splatlas
