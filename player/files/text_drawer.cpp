#include "player/files/text_drawer.h"

#include <string>
#include <utility>

#include "format/result_macros.h"
#include "player/files/load_module.h"

namespace splatlas {
namespace {

/// The result of a call of the module.
template <typename T>
Result<T> checked(T result, const std::string& error) {
  if (!error.empty()) return fail(ErrorCode::kFailed, error);
  return result;
}

}  // namespace

TextDrawer::TextDrawer(const std::filesystem::path& font) {
  opening_ = std::async(std::launch::async, [file = font.string()]() -> Result<Engine> {
    SPLATLAS_ASSIGN_OR_RETURN(void* const function,
                              load_function(kTextModule, kOpenTextEngineName, "Pango and Cairo"));
    Engine engine;
    std::string error;
    reinterpret_cast<OpenTextEngine>(function)(file, engine, error);
    return checked(std::move(engine), error);
  });
}

Result<void> TextDrawer::wait() {
  if (opening_.valid()) opened_ = opening_.get();
  if (!opened_) return tl::unexpected(opened_.error());
  return {};
}

double TextDrawer::width(std::string_view text, double size, FontStyle style) const {
  return (*opened_)->width(text, size, style);
}

bool TextDrawer::lacks_glyphs(std::string_view text) const {
  return (*opened_)->lacks_glyphs(text);
}

Result<TextCoverage> TextDrawer::draw(const PlacedText& text) const {
  std::string error;
  TextCoverage drawn = (*opened_)->draw(text, error);
  return checked(std::move(drawn), error);
}

Result<std::vector<std::byte>> TextDrawer::encode_pdf(const PdfPage& page) const {
  std::string error;
  std::vector<std::byte> bytes = (*opened_)->encode_pdf(page, error);
  return checked(std::move(bytes), error);
}

}  // namespace splatlas
