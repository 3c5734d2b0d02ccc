// OpenJPEG's encoder in memory. A source of its own: see preprocess/CMakeLists.txt.
#include <cstring>
#include <memory>
#include <stdexcept>

#include <openjpeg.h>

#include "tests/preprocess/import/images/dicom/dicom_files.h"

namespace splatlas {
namespace {

struct Sink {
  std::string bytes;
  std::size_t position = 0;
};

OPJ_SIZE_T write_sink(void* from, OPJ_SIZE_T count, void* user) {
  auto& sink = *static_cast<Sink*>(user);
  if (sink.bytes.size() < sink.position + count) sink.bytes.resize(sink.position + count);
  std::memcpy(&sink.bytes[sink.position], from, count);
  sink.position += count;
  return count;
}

OPJ_OFF_T skip_sink(OPJ_OFF_T count, void* user) {
  static_cast<Sink*>(user)->position += static_cast<std::size_t>(count);
  return count;
}

OPJ_BOOL seek_sink(OPJ_OFF_T position, void* user) {
  static_cast<Sink*>(user)->position = static_cast<std::size_t>(position);
  return OPJ_TRUE;
}

}  // namespace

std::string encoded_jpeg_2000(const std::vector<std::int32_t>& values, int columns, int rows, int bits,
                              bool is_signed) {
  opj_image_cmptparm_t format{};
  format.dx = format.dy = 1;
  format.w = static_cast<OPJ_UINT32>(columns);
  format.h = static_cast<OPJ_UINT32>(rows);
  format.prec = static_cast<OPJ_UINT32>(bits);
  format.sgnd = is_signed ? 1 : 0;
  const std::unique_ptr<opj_image_t, void (*)(opj_image_t*)> image(
      opj_image_create(1, &format, OPJ_CLRSPC_GRAY), opj_image_destroy);
  image->x1 = format.w;
  image->y1 = format.h;
  std::memcpy(image->comps[0].data, values.data(), values.size() * sizeof(std::int32_t));
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  parameters.numresolution = 2;
  parameters.tcp_numlayers = 1;
  parameters.tcp_rates[0] = 0;
  parameters.cp_disto_alloc = 1;
  const std::unique_ptr<opj_codec_t, void (*)(opj_codec_t*)> codec(opj_create_compress(OPJ_CODEC_J2K),
                                                                   opj_destroy_codec);
  const std::unique_ptr<opj_stream_t, void (*)(opj_stream_t*)> stream(opj_stream_create(1 << 16, OPJ_FALSE),
                                                                      opj_stream_destroy);
  Sink sink;
  opj_stream_set_write_function(stream.get(), write_sink);
  opj_stream_set_skip_function(stream.get(), skip_sink);
  opj_stream_set_seek_function(stream.get(), seek_sink);
  opj_stream_set_user_data(stream.get(), &sink, nullptr);
  if (opj_setup_encoder(codec.get(), &parameters, image.get()) == OPJ_FALSE ||
      opj_start_compress(codec.get(), image.get(), stream.get()) == OPJ_FALSE ||
      opj_encode(codec.get(), stream.get()) == OPJ_FALSE ||
      opj_end_compress(codec.get(), stream.get()) == OPJ_FALSE)
    throw std::runtime_error("JPEG 2000");
  return sink.bytes;
}

}  // namespace splatlas
