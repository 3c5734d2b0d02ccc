// Writes whole folders, or none.
#pragma once

#include <filesystem>
#include <memory>

#include "format/result.h"

namespace splatlas {

/// A folder under a temporary name, beside the one that it becomes; as OutputFile is for files. Interrupts
/// must wait while one exists (DeferInterrupts).
class OutputFolder {
 public:
  /// kFailed as check_writable_folder() has it, or when the temporary cannot be made.
  [[nodiscard]] static Result<OutputFolder> create(const std::filesystem::path& target);
  ~OutputFolder();
  OutputFolder(OutputFolder&&) noexcept;
  OutputFolder& operator=(OutputFolder&&) noexcept;

  /// To write files into.
  [[nodiscard]] const std::filesystem::path& temporary() const;
  /// Renames it to the target, which must not be there or be an empty folder. Its files are committed by now.
  [[nodiscard]] Result<void> commit();

 private:
  struct Impl;
  explicit OutputFolder(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace splatlas
