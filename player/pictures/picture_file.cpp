#include "player/pictures/picture_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include "player/pictures/picture_module.h"

namespace splatlas {
namespace {

/// The ending in lower case, one spelling per format; empty when it is not known.
std::string known_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending == ".jpeg") ending = ".jpg";
  if (ending == ".tiff") ending = ".tif";
  for (const char* known : {".png", ".jpg", ".tif", ".exr"}) {
    if (ending == known) return ending;
  }
  return {};
}

Result<void*> load_module() {
  void* module = dlopen(kPictureModule, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    const char* reason = dlerror();
    return fail(ErrorCode::kFailed, fmt::format("cannot load {} (OpenImageIO): {}", kPictureModule,
                                                reason ? reason : "unknown reason"));
  }
  void* function = dlsym(module, kWritePixelsName);
  if (function == nullptr) {
    return fail(ErrorCode::kFailed,
                fmt::format("{} has no {}: it is of another version", kPictureModule, kWritePixelsName));
  }
  return function;
}

/// A file beside its target, removed unless it is renamed to it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target, const std::string& ending)
      : target_(target),
        path_(target.parent_path() / fmt::format(".{}.{}.part{}", target.stem().string(), getpid(), ending)) {
  }
  ~TemporaryFile() {
    std::error_code ignored;
    if (!renamed_) std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] Result<void> rename() {
    std::error_code failure;
    std::filesystem::rename(path_, target_, failure);
    if (failure) {
      return fail(ErrorCode::kFailed,
                  fmt::format("{}: cannot be written: {}", target_.string(), failure.message()));
    }
    renamed_ = true;
    return {};
  }

 private:
  std::filesystem::path target_, path_;
  bool renamed_ = false;
};

}  // namespace

PictureWriter::PictureWriter() : module_(std::async(std::launch::async, load_module)) {}

Result<void> PictureWriter::check_ending(const std::filesystem::path& path) {
  if (!known_ending(path).empty()) return {};
  return fail(ErrorCode::kUsage, fmt::format("{}: unknown picture ending '{}'; use .png, .jpg, .tif or .exr",
                                             path.string(), path.extension().string()));
}

Result<void> PictureWriter::write(const Picture& picture, const std::filesystem::path& path,
                                  std::optional<Rgb> background) {
  SPLATLAS_RETURN_IF_ERROR(check_ending(path));
  if (function_ == nullptr) {
    SPLATLAS_ASSIGN_OR_RETURN(function_, module_.get());
  }
  const std::string ending = known_ending(path);
  const bool is_float = ending == ".exr";
  std::vector<std::uint8_t> bytes;
  int channels = 4;
  const void* pixels = picture.rgba.data();
  if (!is_float) {
    if (!background && ending == ".jpg") background = Rgb{0, 0, 0};
    channels = background ? 3 : 4;
    bytes = background ? to_srgb8(picture, *background) : to_srgba8(picture);
    pixels = bytes.data();
  }
  TemporaryFile temporary(path, ending);
  std::array<char, 512> error{};
  const auto write_pixels = reinterpret_cast<WritePixels>(function_);
  if (write_pixels(temporary.path().c_str(), ending.c_str(), picture.size.width, picture.size.height,
                   channels, is_float ? 1 : 0, pixels, error.data(), error.size()) != 0) {
    return fail(ErrorCode::kFailed, fmt::format("{}: cannot be written: {}", path.string(), error.data()));
  }
  return temporary.rename();
}

}  // namespace splatlas
