// PageEngine as C functions, for a page's script: splatlas.js calls them.
//
// A module has one engine. An answer, a picture and the input are valid until the next call.
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "player/web/page_engine.h"

#ifdef __wasm__
#define SPLATLAS_WEB(name) extern "C" __attribute__((export_name(#name), used))
#else  // for tools that read the source
#define SPLATLAS_WEB(name) extern "C"
#endif

namespace splatlas {
namespace {

/// The module's state.
struct WebModule {
  PageEngine engine{{.threads = 1}};
  std::vector<std::byte> input;
  PageAnswer answer;
  std::vector<std::uint8_t> pixels;
};

WebModule& module() {
  static WebModule module;
  return module;
}

}  // namespace
}  // namespace splatlas

using namespace splatlas;  // NOLINT(google-build-using-namespace): C functions stand in no namespace

/// Makes room for the input of the next call: bytes, then the request in UTF-8. Null: out of memory.
SPLATLAS_WEB(splatlas_input) std::uint8_t* splatlas_input(std::uint32_t bytes) try {
  module().input.resize(bytes);
  return reinterpret_cast<std::uint8_t*>(module().input.data());
} catch (const std::exception&) {
  return nullptr;
}

/// Answers the request, the last bytes of the input. Returns PageAnswer::status.
SPLATLAS_WEB(splatlas_call) int splatlas_call(std::uint32_t request_bytes) try {
  std::vector<std::byte> bytes = std::exchange(module().input, {});
  const std::size_t rest = bytes.size() - request_bytes;
  const std::string request(reinterpret_cast<const char*>(bytes.data()) + rest, request_bytes);
  bytes.resize(rest);
  module().answer = module().engine.call(request, std::move(bytes));
  return module().answer.status;
} catch (const std::exception&) {
  module().answer.text = "out of memory";
  return 1 + static_cast<int>(ErrorCode::kLimit);
}

/// The latest answer's text, in UTF-8, and its bytes.
SPLATLAS_WEB(splatlas_text) const char* splatlas_text() {
  return module().answer.text.data();
}
SPLATLAS_WEB(splatlas_text_bytes) std::uint32_t splatlas_text_bytes() {
  return static_cast<std::uint32_t>(module().answer.text.size());
}

/// The picture: linear RGBA, premultiplied; 4 * width * height floats, top row first.
SPLATLAS_WEB(splatlas_floats) const float* splatlas_floats() {
  return module().engine.frame().picture.rgba.data();
}

/// After a finished picture: the next selection takes the memory of its buffers.
SPLATLAS_WEB(splatlas_rest) void splatlas_rest() {
  module().engine.rest();
}

/// The same as 8-bit sRGB with straight alpha, for ImageData. Null when out of memory.
SPLATLAS_WEB(splatlas_pixels) const std::uint8_t* splatlas_pixels() try {
  const std::vector<float>& rgba = module().engine.frame().picture.rgba;
  module().pixels.resize(rgba.size());
  to_srgba8(rgba, module().pixels.data());
  return module().pixels.data();
} catch (const std::exception&) {
  return nullptr;
}
