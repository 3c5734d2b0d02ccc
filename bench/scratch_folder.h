// Temporary folder of a bench, removed by its owner.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// A new folder below the system temporary folder, readable by this user only; removed with its contents at
/// the end.
class ScratchFolder {
 public:
  [[nodiscard]] static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;  // empty after a move
};

}  // namespace splatlas
