// A fuzzer's bytes as a file, for readers that want a path.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace splatlas {

/// Writes `bytes` to a file called `name` in a folder of this process's own, over what was there. The folder
/// goes when the process ends as it should.
[[nodiscard]] std::filesystem::path write_input_file(const std::string& name,
                                                     std::span<const std::byte> bytes);

}  // namespace splatlas
