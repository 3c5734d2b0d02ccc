// Atomic creation of folders.
#pragma once

#include <filesystem>
#include <memory>

#include "format/result.h"
#include "format/system/temporary_entry.h"

namespace splatlas {

/// A temporary folder beside its target, analogous to OutputFile. Requires DeferInterrupts during its
/// lifetime.
class OutputFolder {
 public:
  /// Creates the temporary folder. kFailed if this fails, or as in check_writable_folder().
  [[nodiscard]] static Result<OutputFolder> create(const std::filesystem::path& target);

  /// The temporary folder, for writing files.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_->path(); }
  /// Renames it to the target, which must not exist or be an empty folder. Its files must be committed.
  [[nodiscard]] Result<void> commit();

 private:
  OutputFolder() = default;

  std::filesystem::path path_, target_;  // as given, and with links resolved
  std::unique_ptr<TemporaryEntry> temporary_ = std::make_unique<TemporaryEntry>();
};

}  // namespace splatlas
