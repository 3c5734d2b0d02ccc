// JPEG 2000 images in memory, by OpenJPEG.
#include <algorithm>
#include <cstring>
#include <memory>
#include <string_view>

#include <openjpeg.h>

#include "format/result_macros.h"
#include "preprocess/import/images/dicom/decode/decode_frame.h"

namespace splatlas {
namespace {

struct MemoryStream {
  std::span<const std::byte> bytes;
  std::size_t position = 0;

  [[nodiscard]] std::size_t left() const { return bytes.size() - position; }
};

OPJ_SIZE_T read_memory(void* to, OPJ_SIZE_T count, void* user) {
  auto& stream = *static_cast<MemoryStream*>(user);
  const OPJ_SIZE_T taken = std::min<OPJ_SIZE_T>(count, stream.left());
  if (taken == 0) return static_cast<OPJ_SIZE_T>(-1);  // the end
  std::memcpy(to, &stream.bytes[stream.position], taken);
  stream.position += taken;
  return taken;
}

OPJ_OFF_T skip_memory(OPJ_OFF_T count, void* user) {
  auto& stream = *static_cast<MemoryStream*>(user);
  if (count < 0 || static_cast<std::uint64_t>(count) > stream.left()) return -1;
  stream.position += static_cast<std::size_t>(count);
  return count;
}

OPJ_BOOL seek_memory(OPJ_OFF_T position, void* user) {
  auto& stream = *static_cast<MemoryStream*>(user);
  if (position < 0 || static_cast<std::uint64_t>(position) > stream.bytes.size()) return OPJ_FALSE;
  stream.position = static_cast<std::size_t>(position);
  return OPJ_TRUE;
}

struct Destroy {
  void operator()(opj_stream_t* stream) const { opj_stream_destroy(stream); }
  void operator()(opj_image_t* image) const { opj_image_destroy(image); }
};
using Stream = std::unique_ptr<opj_stream_t, Destroy>;
using Image = std::unique_ptr<opj_image_t, Destroy>;

/// Streams and codecs have the same type, void*.
struct DestroyCodec {
  void operator()(opj_codec_t* codec) const { opj_destroy_codec(codec); }
};
using Codec = std::unique_ptr<opj_codec_t, DestroyCodec>;

bool is_jp2(std::span<const std::byte> bytes) {
  constexpr std::string_view kMark = "jP  ";
  constexpr std::size_t kOffset = 4;
  return bytes.size() >= kOffset + kMark.size() &&
         std::memcmp(&bytes[kOffset], kMark.data(), kMark.size()) == 0;
}

tl::unexpected<Error> damaged() {
  return fail(ErrorCode::kFailed, "has damaged JPEG 2000 pixels; get the file again");
}

}  // namespace

Result<void> decode_jpeg_2000(std::span<const std::byte> bytes, const PixelFormat& format,
                              std::vector<std::int32_t>& values) {
  if (bytes.empty()) return damaged();
  MemoryStream memory{bytes};
  const Stream stream(opj_stream_create(1 << 16, OPJ_TRUE));
  const Codec codec(opj_create_decompress(is_jp2(bytes) ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K));
  if (!stream || !codec) return damaged();
  opj_stream_set_read_function(stream.get(), read_memory);
  opj_stream_set_skip_function(stream.get(), skip_memory);
  opj_stream_set_seek_function(stream.get(), seek_memory);
  opj_stream_set_user_data(stream.get(), &memory, nullptr);
  opj_stream_set_user_data_length(stream.get(), bytes.size());
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  // Without the strict mode, cut images are filled up.
  if (opj_setup_decoder(codec.get(), &parameters) == OPJ_FALSE ||
      opj_decoder_set_strict_mode(codec.get(), OPJ_TRUE) == OPJ_FALSE)
    return damaged();
  opj_image_t* raw_image = nullptr;
  const bool has_header = opj_read_header(stream.get(), codec.get(), &raw_image) != OPJ_FALSE;
  const Image image(raw_image);
  if (!has_header || !image || image->numcomps < 1) return damaged();
  const opj_image_comp_t& component = image->comps[0];
  if (image->numcomps != 1 || component.w != static_cast<OPJ_UINT32>(format.columns) ||
      component.h != static_cast<OPJ_UINT32>(format.rows) ||
      component.prec > static_cast<OPJ_UINT32>(format.bits_allocated))
    return fail(ErrorCode::kFailed,
                "has JPEG 2000 pixels of another size than its header says; get it again");
  if (opj_decode(codec.get(), stream.get(), image.get()) == OPJ_FALSE ||
      opj_end_decompress(codec.get(), stream.get()) == OPJ_FALSE || component.data == nullptr ||
      component.w != static_cast<OPJ_UINT32>(format.columns) ||
      component.h != static_cast<OPJ_UINT32>(format.rows))
    return damaged();
  values.assign(component.data, component.data + static_cast<std::size_t>(component.w) * component.h);
  return {};
}

}  // namespace splatlas
