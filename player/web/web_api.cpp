#include "player/web/web_api.h"

#include <cstddef>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "player/web/page_engine.h"

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

std::uint8_t* splatlas_input(std::uint32_t bytes) try {
  module().input.resize(bytes);
  return reinterpret_cast<std::uint8_t*>(module().input.data());
} catch (const std::exception&) {
  return nullptr;
}

int splatlas_call(std::uint32_t request_bytes) try {
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

const char* splatlas_text() {
  return module().answer.text.data();
}
std::uint32_t splatlas_text_bytes() {
  return static_cast<std::uint32_t>(module().answer.text.size());
}

const float* splatlas_floats() {
  return module().engine.frame().picture.rgba.data();
}

const std::uint8_t* splatlas_pixels() try {
  const Picture& picture = module().engine.frame().picture;
  module().pixels.resize(picture.rgba.size());
  return to_srgba8(picture, module().pixels) ? module().pixels.data() : nullptr;
} catch (const std::exception&) {
  return nullptr;
}
