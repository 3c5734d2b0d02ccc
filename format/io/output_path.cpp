#include "format/io/output_path.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "format/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// The effective user decides, as for the later write.
Result<void> check_access(const fs::path& path, const fs::path& of, int mode) {
  if (::faccessat(AT_FDCWD, of.c_str(), mode, AT_EACCESS) == 0) return {};
  return cannot_write(path, std::strerror(errno));
}

Result<void> check_folder_of(const fs::path& path) {
  const fs::path target = resolve_output(path);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  std::error_code error;
  if (fs::is_directory(folder, error)) return check_access(path, folder, W_OK | X_OK);
  return cannot_write(path, fmt::format("there is no folder {}", folder.string()));
}

}  // namespace

fs::path resolve_output(const fs::path& path) {
  constexpr int kMaxLinks = 40;  // limit of the Linux kernel
  fs::path target = path;
  std::error_code error;
  for (int n = 0; n < kMaxLinks && fs::is_symlink(fs::symlink_status(target, error)); ++n) {
    const fs::path link = fs::read_symlink(target, error);
    if (error) return target;
    target = target.parent_path() / link;  // `link` if it is absolute
  }
  const fs::path folder = fs::canonical(target.has_parent_path() ? target.parent_path() : ".", error);
  return error ? target : folder / target.filename();
}

tl::unexpected<Error> cannot_write(const fs::path& path, std::string_view reason) {
  return fail(ErrorCode::kFailed, "{}: cannot be written: {}", path.string(), reason);
}

Result<void> check_writable_file(const fs::path& path) {
  if (path.empty()) return fail(ErrorCode::kUsage, "\"\": the output must have a name");
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) return cannot_write(path, error.message());
  if (path.filename().empty() || fs::is_directory(status)) return cannot_write(path, "it is a folder");
  if (fs::exists(status)) {
    if (!fs::is_regular_file(status)) return cannot_write(path, "it is not a regular file");
    SPLATLAS_RETURN_IF_ERROR(check_access(path, path, W_OK));
  }
  return check_folder_of(path);
}

Result<void> check_writable_folder(const fs::path& path) {
  const fs::path target = (path / "").parent_path();
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (status.type() == fs::file_type::none) return cannot_write(path, error.message());
  if (fs::exists(status) && !(fs::is_directory(status) && fs::is_empty(target, error)))
    return cannot_write(path, "it exists and is not an empty folder; name a new one");
  return check_folder_of(target);
}

Result<void> check_outputs(std::span<const fs::path> outputs, std::span<const fs::path> inputs) {
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    const fs::path& output = outputs[n];
    const auto same = [&](const fs::path& other) {
      if (output.empty() || other.empty()) return false;
      std::error_code none;
      return fs::equivalent(output, other, none) || resolve_output(output) == resolve_output(other);
    };
    if (const auto input = std::ranges::find_if(inputs, same); input != inputs.end())
      return fail(ErrorCode::kUsage, "{}: is an input ({}); write to another file", output.string(),
                  input->string());
    if (const auto other = std::ranges::find_if(outputs.first(n), same); other != outputs.begin() + n)
      return fail(ErrorCode::kUsage, "{}: is another output, too ({}); write to two files", output.string(),
                  other->string());
  }
  return {};
}

}  // namespace splatlas
