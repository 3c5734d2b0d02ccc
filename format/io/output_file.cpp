#include "format/io/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/io/interrupts.h"
#include "format/io/output_path.h"
#include "format/io/staged_file.h"
#include "format/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxWriteBytes = std::size_t{1} << 26;

}  // namespace

OutputFile::OutputFile(std::unique_ptr<UnfinishedFile> impl) : impl_(std::move(impl)) {}
OutputFile::~OutputFile() = default;
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;

Result<OutputFile> OutputFile::create(const fs::path& target) {
  auto impl = std::make_unique<UnfinishedFile>();
  impl->path = target;
  impl->target = resolve_output(target);
  struct stat old {};
  if (::stat(target.c_str(), &old) == 0) {
    if (!S_ISREG(old.st_mode)) {
      return cannot_write(target, S_ISDIR(old.st_mode) ? "it is a folder" : "it is not a regular file");
    }
    if (::faccessat(AT_FDCWD, target.c_str(), W_OK, AT_EACCESS) != 0)
      return cannot_write(target, std::strerror(errno));
    impl->old = old;
  } else if (errno != ENOENT) {
    return cannot_write(target, std::strerror(errno));
  }
  if (target.filename().empty()) return cannot_write(target, "it names no file");
  FolderHandle folder;
  if (!folder.open(impl->target.parent_path())) return cannot_write(target, std::strerror(errno));
  SPLATLAS_RETURN_IF_ERROR(impl->create(std::move(folder)));
  return OutputFile(std::move(impl));
}

fs::path OutputFile::temporary() const {
  return impl_->staged.path();
}

Result<void> OutputFile::write(std::span<const std::byte> bytes) {
  if (!impl_->written) impl_->written.emplace();
  while (!bytes.empty()) {
    const ssize_t written =
        ::write(impl_->staged.descriptor(), bytes.data(), std::min(bytes.size(), kMaxWriteBytes));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return cannot_write(impl_->path, std::strerror(errno));
    impl_->written->add(bytes.first(static_cast<std::size_t>(written)));
    impl_->written_bytes += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> OutputFile::commit() {
  return commit_files({this, 1});
}

Result<void> commit_files(std::span<OutputFile> files) {
  for (const OutputFile& file : files) SPLATLAS_RETURN_IF_ERROR(file.impl_->complete());
  const DeferInterrupts all_or_none;
  for (const OutputFile& file : files) {
    UnfinishedFile& impl = *file.impl_;
    const FolderHandle& folder = impl.staged.folder();
    if (!impl.staged.publish(folder, impl.target.filename()))
      return cannot_write(impl.path, std::strerror(errno));
    if (!folder.sync()) return cannot_sync_folder(impl.path, std::strerror(errno));
  }
  return {};
}

Result<void> add_file(const fs::path& path, std::span<const std::byte> bytes,
                      std::vector<OutputFile>& files) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path));
  files.push_back(std::move(file));
  return files.back().write(bytes);
}

Result<void> write_file(const fs::path& path, std::span<const std::byte> bytes) {
  std::vector<OutputFile> files;
  SPLATLAS_RETURN_IF_ERROR(add_file(path, bytes, files));
  return commit_files(files);
}

}  // namespace splatlas
