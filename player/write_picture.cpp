#include "player/write_picture.h"

#include "format/io/output_file.h"
#include "format/result_macros.h"
#include "player/files/picture_encoder.h"

namespace splatlas {

Result<void> write_picture(const Picture& picture, const std::filesystem::path& path,
                           std::optional<Rgb> background) {
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_ending(path));
  SPLATLAS_RETURN_IF_ERROR(PictureEncoder::check_size(path, picture.size, background));
  Picture to_encode = picture;
  SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> bytes,
                            PictureEncoder(path).encode(to_encode, background));
  return write_file(path, bytes);
}

}  // namespace splatlas
