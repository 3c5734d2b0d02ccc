// Atomic creation of folders.
#pragma once

#include <filesystem>
#include <memory>

#include "format/result.h"

namespace splatlas {

/// A temporary folder beside its target, analogous to OutputFile. Requires DeferInterrupts during its
/// lifetime.
class OutputFolder {
 public:
  /// Creates the temporary folder. kFailed if this fails, or as in check_writable_folder().
  [[nodiscard]] static Result<OutputFolder> create(const std::filesystem::path& target);
  ~OutputFolder();
  OutputFolder(OutputFolder&&) noexcept;
  OutputFolder& operator=(OutputFolder&&) noexcept;

  /// The temporary folder, for writing files.
  [[nodiscard]] const std::filesystem::path& temporary() const;
  /// Renames it to the target, which must not exist or be an empty folder. Its files must be committed.
  [[nodiscard]] Result<void> commit();

 private:
  struct Impl;
  explicit OutputFolder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
