#include "format/io/output_path.h"

#include <system_error>

#include "format/result_macros.h"

namespace splatlas {

namespace fs = std::filesystem;

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

tl::unexpected<Error> cannot_sync_folder(const fs::path& path, std::string_view reason) {
  return fail(ErrorCode::kFailed, "{}: is written whole, but its folder cannot be synced: {}", path.string(),
              reason);
}

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  const bool same = fs::equivalent(a, b, error);
  return (same && !error) || resolve_output(a) == resolve_output(b);
}

Result<void> check_outputs(std::span<const fs::path> outputs, std::span<const fs::path> inputs) {
  for (std::size_t n = 0; n < outputs.size(); ++n) {
    const fs::path& output = outputs[n];
    if (output.empty()) continue;
    for (const fs::path& input : inputs) {
      if (input.empty() || !is_same_file(output, input)) continue;
      return fail(ErrorCode::kUsage, "{}: is an input ({}); write to another file", output.string(),
                  input.string());
    }
    for (const fs::path& other : outputs.first(n)) {
      if (other.empty() || !is_same_file(output, other)) continue;
      return fail(ErrorCode::kUsage, "{}: is another output, too ({}); write to two files", output.string(),
                  other.string());
    }
  }
  return {};
}

}  // namespace splatlas
