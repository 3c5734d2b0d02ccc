#include "preprocess/export/temporary_output.h"

#include "format/system/ascii_text.h"
#include "format/system/output_file.h"
#include "format/system/result_macros.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// File extension; ".nii.gz" counts as one.
std::string ending_of(const fs::path& path) {
  const std::string last = path.extension().string();
  return to_lower(last) == ".gz" ? path.stem().extension().string() + last : last;
}

}  // namespace

Result<void> write_atomically(const fs::path& path,
                              const std::function<Result<void>(const fs::path&)>& write) {
  SPLATLAS_ASSIGN_OR_RETURN(OutputFile file, OutputFile::create(path, ending_of(path)));
  SPLATLAS_RETURN_IF_ERROR(write(file.temporary()));
  return file.commit();
}

std::string with_path(std::string message, const fs::path& temporary, const fs::path& path) {
  const std::string &from = temporary.native(), &to = path.native();
  for (std::size_t at = message.find(from); at != std::string::npos; at = message.find(from, at + to.size()))
    message.replace(at, from.size(), to);
  return message;
}

}  // namespace splatlas
