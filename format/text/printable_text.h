// Text for terminals: layout of the program with escaped pieces.
#pragma once

#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "format/text/ascii_text.h"

namespace splatlas {

/// A piece of PrintableText: printable() text, or the number itself.
template <typename T>
[[nodiscard]] auto printable_piece(const T& piece) {
  if constexpr (std::is_same_v<T, std::filesystem::path>) {
    return printable(piece.string());
  } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    return printable(piece);
  } else {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, char>, "pieces are texts, paths and numbers");
    return piece;
  }
}

template <typename T>
using PrintablePiece = decltype(printable_piece(std::declval<const T&>()));

/// Text that is safe to print. Only layout, which is part of the program, has line feeds and other control
/// characters. Pieces may come from files and command lines: they are printable(). The streams of
/// format/program/standard_output.h print nothing else.
class PrintableText {
 public:
  PrintableText() = default;
  template <typename... Pieces>
  explicit PrintableText(fmt::format_string<PrintablePiece<Pieces>...> layout, const Pieces&... pieces) {
    add(layout, pieces...);
  }
  /// A finished layout without foreign pieces: help, or JSON of json_text(). Keeps line feeds and tabs only.
  [[nodiscard]] static PrintableText of_layout(std::string_view layout) {
    PrintableText text;
    text.text_ = printable_lines(layout);
    return text;
  }

  template <typename... Pieces>
  PrintableText& add(fmt::format_string<PrintablePiece<Pieces>...> layout, const Pieces&... pieces) {
    fmt::format_to(std::back_inserter(text_), layout, printable_piece(pieces)...);
    return *this;
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace splatlas
