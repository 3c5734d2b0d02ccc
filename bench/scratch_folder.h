// A folder that goes when its owner does.
#pragma once

#include <filesystem>

#include "format/result.h"

namespace splatlas {

/// Made empty in the system's folder for temporary files, readable by this user only; removed with everything
/// in it at the end.
class ScratchFolder {
 public:
  [[nodiscard]] static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;  // empty: moved away
};

}  // namespace splatlas
