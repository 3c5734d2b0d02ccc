#include "player/files/text_drawer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "format/result_macros.h"
#include "player/files/load_module.h"
#include "player/files/picture_module.h"

namespace splatlas {
namespace {

constexpr int kOversampling = 4;
constexpr int kMeasuredSize = 200;  // pixels per em: advances are whole pixels

struct FontFamily {
  const char *regular, *bold, *italic;
};
constexpr FontFamily kFamilies[] = {
    {"liberation/LiberationSans-Regular.ttf", "liberation/LiberationSans-Bold.ttf",
     "liberation/LiberationSans-Italic.ttf"},
    {"dejavu/DejaVuSans.ttf", "dejavu/DejaVuSans-Bold.ttf", "dejavu/DejaVuSans-Oblique.ttf"}};

Result<TextExtents> call(void* function, const TextToDraw& text, TakeCoverage take, void* context) {
  std::array<char, 512> error{};
  TextExtents extents{};
  const auto draw = reinterpret_cast<DrawText>(function);
  if (draw(&text, &extents, take, context, error.data(), error.size()) == 0) return extents;
  return fail(ErrorCode::kFailed, error.data());
}

/// Average of kOversampling^2 samples for each pixel. `dx` and `dy` shift the samples by parts of a pixel.
TextCoverage averaged(const TextExtents& extents, const float* samples, int dx, int dy) {
  const auto down = [](int n) {
    return static_cast<int>(std::floor(static_cast<double>(n) / kOversampling));
  };
  const int left = extents.left + dx, top = extents.top + dy;
  const int columns = extents.right - extents.left, rows = extents.bottom - extents.top;
  TextCoverage text{down(left), down(top), 0, 0, {}};
  text.width = down(left + columns - 1) - text.left + 1;
  text.height = down(top + rows - 1) - text.top + 1;
  text.coverage.resize(static_cast<std::size_t>(text.width) * static_cast<std::size_t>(text.height));
  constexpr float kShare = 1.0f / (kOversampling * kOversampling);
  for (int j = 0; j < rows; ++j) {
    const auto row =
        static_cast<std::size_t>(down(top + j) - text.top) * static_cast<std::size_t>(text.width);
    for (int i = 0; i < columns; ++i, ++samples) {
      text.coverage[row + static_cast<std::size_t>(down(left + i) - text.left)] += kShare * *samples;
    }
  }
  return text;
}

}  // namespace

Result<FontFiles> find_fonts(const std::filesystem::path& chosen, const std::filesystem::path& root) {
  std::error_code ignored;
  const auto exists = [&](const std::filesystem::path& file) {
    return std::filesystem::is_regular_file(file, ignored);
  };
  if (!chosen.empty()) {
    if (exists(chosen)) return FontFiles{chosen, chosen, chosen};
    return fail(ErrorCode::kFailed, "{}: is no font file; give a .ttf or .otf file", chosen.string());
  }
  for (const FontFamily& family : kFamilies) {
    const std::filesystem::path regular = root / family.regular;
    if (!exists(regular)) continue;
    const auto or_regular = [&](const char* name) { return exists(root / name) ? root / name : regular; };
    return FontFiles{regular, or_regular(family.bold), or_regular(family.italic)};
  }
  return fail(
      ErrorCode::kFailed,
      "{}: has neither Liberation Sans nor DejaVu Sans; install fonts-liberation or fonts-dejavu-core, "
      "or take --font FILE",
      root.string());
}

TextDrawer::TextDrawer(FontFiles fonts) : fonts_(std::move(fonts)) {
  if (fonts_.front().empty()) return;
  module_ = std::async(std::launch::async,
                       [] { return load_function(kPictureModule, kDrawTextName, "OpenImageIO"); });
}

Result<void> TextDrawer::wait() {
  if (function_ == nullptr) {
    SPLATLAS_ASSIGN_OR_RETURN(function_, module_.get());
  }
  for (const std::filesystem::path& font : fonts_) {
    const TextToDraw letter{"M", font.c_str(), kMeasuredSize};
    SPLATLAS_RETURN_IF_ERROR(call(function_, letter, nullptr, nullptr));
  }
  return {};
}

double TextDrawer::width(std::string_view text, double size, FontStyle style) const {
  const std::string words(text);
  const TextToDraw line{words.c_str(), fonts_[static_cast<std::size_t>(style)].c_str(), kMeasuredSize};
  const auto extents = call(function_, line, nullptr, nullptr);
  return extents ? extents->right * size / kMeasuredSize : 0;
}

Result<TextCoverage> TextDrawer::draw(const PlacedText& text) const {
  const int size = std::max(1, static_cast<int>(std::lround(kOversampling * text.size)));
  const TextToDraw line{text.text.c_str(), fonts_[static_cast<std::size_t>(text.style)].c_str(), size};
  struct Context {
    int dx, dy;
    TextCoverage coverage;
  } context{static_cast<int>(std::lround(kOversampling * text.x)),
            static_cast<int>(std::lround(kOversampling * text.y)),
            {}};
  const TakeCoverage take = [](void* to, const TextExtents* extents, const float* samples) {
    auto* const into = static_cast<Context*>(to);
    into->coverage = averaged(*extents, samples, into->dx, into->dy);
  };
  SPLATLAS_RETURN_IF_ERROR(call(function_, line, take, &context));
  return std::move(context.coverage);
}

}  // namespace splatlas
