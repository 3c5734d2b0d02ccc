// Atlas::copy_with_scenes.
#include <utility>
#include <vector>

#include "format/file/reader/atlas_impl.h"
#include "format/result_macros.h"

namespace splatlas {

Result<void> Atlas::copy_with_scenes(
    std::vector<Scene> scenes, const std::function<Result<void>(std::span<const std::byte>)>& write) const {
  if (impl_->directory.has_newer_fields) {
    return impl_->named(ErrorCode::kFailed,
                        "format {} has entries in the directory that this program cannot copy; take a newer "
                        "version of it",
                        format_version());
  }
  return impl_->guarded([&]() -> Result<void> {
    Directory directory = impl_->directory;
    directory.scenes = std::move(scenes);
    const auto refuse = [&](const Error& error) {
      return Error{ErrorCode::kFailed, name() + ": " + error.message, {}};
    };
    SPLATLAS_RETURN_IF_ERROR(validate(directory, impl_->run_streams).map_error(refuse));
    SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes,
                              encode_directory(directory).map_error(refuse));
    const FileHeader& old = impl_->header;
    const FileHeader header = make_header(bytes, old.file_bytes - old.directory_bytes + bytes.size(), old);
    SPLATLAS_RETURN_IF_ERROR(write(std::as_bytes(std::span(&header, 1))));
    SPLATLAS_RETURN_IF_ERROR(write(bytes));
    for (std::size_t n = 0; n < impl_->layout.sections.size(); ++n) {
      for (std::uint32_t chunk = 0; chunk < directory.sections[n].chunks; ++chunk) {
        const auto stored = impl_->sections.read_chunk_of(impl_->layout.sections[n], chunk);
        if (!stored) return impl_->named(stored.error());
        SPLATLAS_RETURN_IF_ERROR(write(*stored));
      }
    }
    return {};
  });
}

}  // namespace splatlas
