#include "player/web/html_page.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <nettle/base64.h>
#include <nettle/sha2.h>

#include "format/result_macros.h"
#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

/// Defines NAME(), the bytes of files, with SPLATLAS_AND between them, which the assembler includes.
#define SPLATLAS_AND "\"\n.incbin \"" SPLATLAS_WEB_FOLDER
#define SPLATLAS_EMBED(name, path)                                                       \
  __asm__(                                                                               \
      ".pushsection .rodata\n"                                                           \
      ".global splatlas_" #name "_begin\n.hidden splatlas_" #name                        \
      "_begin\n"                                                                         \
      ".global splatlas_" #name "_end\n.hidden splatlas_" #name                          \
      "_end\n"                                                                           \
      "splatlas_" #name "_begin: .incbin \"" path "\"\nsplatlas_" #name                  \
      "_end: .byte 0\n"                                                                  \
      ".popsection\n");                                                                  \
  extern "C" __attribute__((visibility("hidden"))) const char splatlas_##name##_begin[], \
      splatlas_##name##_end[]; /* NOLINT */                                              \
  std::string_view name() {                                                              \
    return {splatlas_##name##_begin,                                                     \
            static_cast<std::size_t>(splatlas_##name##_end - splatlas_##name##_begin)};  \
  }

SPLATLAS_EMBED(page_template, SPLATLAS_WEB_FOLDER "/page/page.html")
SPLATLAS_EMBED(page_style, SPLATLAS_WEB_FOLDER "/page/page.css")
SPLATLAS_EMBED(catalogue_template, SPLATLAS_WEB_FOLDER "/page/catalogue.html")
SPLATLAS_EMBED(catalogue_style, SPLATLAS_WEB_FOLDER "/page/catalogue.css")
SPLATLAS_EMBED(page_script, SPLATLAS_WEB_FOLDER
               "/page/camera.js" SPLATLAS_AND "/page/model.js" SPLATLAS_AND "/page/engine.js" SPLATLAS_AND
               "/page/stage.js" SPLATLAS_AND "/page/tree.js" SPLATLAS_AND "/page/panels.js" SPLATLAS_AND
               "/page/talk.js" SPLATLAS_AND "/page/lesson.js" SPLATLAS_AND "/page/quiz.js" SPLATLAS_AND
               "/page/slices.js" SPLATLAS_AND "/page/page.js")
SPLATLAS_EMBED(worker_script, SPLATLAS_WEB_FOLDER "/splatlas.js" SPLATLAS_AND "/page/worker.js")
/// splatlas.wasm, compressed by gzip. Empty if the program was built without it.
#ifdef SPLATLAS_WEB_MODULE_GZIP
SPLATLAS_EMBED(web_module_gzip, SPLATLAS_WEB_MODULE_GZIP)
#else
std::string_view web_module_gzip() {
  return {};
}
#endif

/// Browsers take a minute to lay out a line of some hundred thousand letters.
constexpr std::size_t kMaxTextBytes = 4000;

/// Two scenes of usual length fit on a printed page.
constexpr std::string_view kHandoutStyle =
    "body { max-width: 60rem; margin: auto; padding: 1rem; font: 1rem/1.4 sans-serif; }"
    "section { break-inside: avoid; overflow-wrap: anywhere; } img { max-width: 100%; max-height: 90vh; }"
    "h1 { font-size: 1.6rem; } h2, em, p { display: block; margin: 0.5rem 0; white-space: pre-line; } h2 { "
    "font-size: 1.2rem; }"
    "@page { margin: 15mm; } @media print { body { padding: 0; } img { max-height: 82mm; } }";

std::string base64(std::span<const std::byte> bytes) {
  std::string text(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
  base64_encode_raw(text.data(), bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  return text;
}

/// The source expression of a content security policy that allows this script or style.
std::string hash_source(std::string_view text) {
  std::array<std::byte, SHA256_DIGEST_SIZE> digest{};
  sha256_ctx context;
  sha256_init(&context);
  sha256_update(&context, text.size(), reinterpret_cast<const std::uint8_t*>(text.data()));
  sha256_digest(&context, digest.size(), reinterpret_cast<std::uint8_t*>(digest.data()));
  return "'sha256-" + base64(digest) + "'";
}

/// Chromium takes no module workers from blob:, and compiles WebAssembly only with 'wasm-unsafe-eval'.
std::string policy(std::string_view script, const HtmlPage& page) {
  return fmt::format(
      "default-src 'none'; script-src {}{}; worker-src blob:; style-src {}; img-src data:; {}"
      "base-uri 'none'; form-action 'none'",
      hash_source(script), page.is_served ? "" : " 'wasm-unsafe-eval'", hash_source(page_style()),
      page.is_served || !page.url.empty() ? "connect-src 'self'; " : "");
}

/// JSON in a data block: no end of the block is in it.
std::string json_in_markup(std::string_view json) {
  std::string text;
  for (const char& c : json) text += c == '<' ? std::string_view("\\u003c") : std::string_view(&c, 1);
  return text;
}

/// Replaces each "{{name}}" of the template by its text, in one pass: texts are not searched.
std::string fill(std::string_view text, std::span<const std::pair<std::string_view, std::string>> values) {
  std::string filled;
  while (!text.empty()) {
    const std::size_t begin = std::min(text.find("{{"), text.size());
    filled += text.substr(0, begin);
    text.remove_prefix(begin);
    const std::size_t end = text.find("}}");
    if (end == std::string_view::npos) break;
    const std::string_view name = text.substr(2, end - 2);
    const auto found = std::ranges::find(values, name, &std::pair<std::string_view, std::string>::first);
    if (found != values.end()) filled += found->second;
    text.remove_prefix(end + 2);
  }
  return filled += text;
}

}  // namespace

Result<void> check_web_module() {
  if (!web_module_gzip().empty()) return {};
  return fail(
      ErrorCode::kFailed,
      "--html: this player was built without splatlas.wasm; build it (cmake --preset web && cmake --build "
      "--preset web, see docs/web.md), then configure and build the player again");
}

Result<std::string> encode_html(const HtmlPage& page) {
  if (!page.is_served) SPLATLAS_RETURN_IF_ERROR(check_web_module());
  const std::string script(page_script());
  const std::string title = page.title.empty() ? "Anatomy atlas" : page.title;
  const std::array<std::pair<std::string_view, std::string>, 12> values{
      {{"policy", policy(script, page)},
       {"title", escaped_markup(shortened(title, kMaxTextBytes))},
       {"caption", escaped_markup(shortened(page.caption, kMaxTextBytes))},
       {"style", std::string(page_style())},
       {"script", script},
       {"picture", base64(page.picture)},
       {"opening", json_in_markup(page.opening)},
       {"worker", std::string(worker_script())},
       {"module", page.is_served ? std::string() : base64(std::as_bytes(std::span(web_module_gzip())))},
       {"served", page.is_served ? " data-served" : ""},
       {"url", page.url},
       {"atlas", base64(page.atlas)}}};
  return fill(page_template(), values);
}

std::string encode_catalogue(std::span<const CatalogueEntry> entries) {
  const std::string_view style = catalogue_style();
  std::string list;
  for (const CatalogueEntry& entry : entries) {
    list += fmt::format(
        "<li><a href=\"{}\"><img src=\"data:image/webp;base64,{}\" alt=\"\"><strong><bdi>{}</bdi></strong>"
        "<span>{}</span></a></li>\n",
        entry.url, base64(entry.picture), escaped_markup(shortened(entry.title, kMaxTextBytes)),
        escaped_markup(entry.text));
  }
  const std::array<std::pair<std::string_view, std::string>, 3> values{
      {{"policy",
        fmt::format("default-src 'none'; style-src {}; img-src data:; base-uri 'none'; form-action 'none'",
                    hash_source(style))},
       {"style", std::string(style)},
       {"list", list}}};
  return fill(catalogue_template(), values);
}

std::string encode_handout(const std::string& title, std::span<const HandoutEntry> entries) {
  const auto text = [](std::string_view any) { return escaped_markup(shortened(any, kMaxTextBytes)); };
  const auto paragraph = [&](std::string_view element, const std::string& any) {
    return any.empty() ? "" : fmt::format("<{0} dir=\"auto\">{1}</{0}>\n", element, text(any));
  };
  const std::string name = title.empty() ? "Lesson" : title;
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta "
      "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src {}; img-src 'self'; "
      "base-uri 'none'; form-action 'none'\">\n<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<title>{}</title>\n<style>{}</style>\n{}",
      hash_source(kHandoutStyle), text(name), kHandoutStyle, paragraph("h1", name));
  for (const HandoutEntry& entry : entries) {
    page += fmt::format("<section>\n{}<img src=\"{}\" alt=\"{}\">\n{}{}</section>\n",
                        paragraph("h2", entry.texts.heading), entry.picture, text(entry.texts.heading),
                        paragraph("em", entry.texts.question), paragraph("p", entry.texts.caption));
  }
  return page + "</html>\n";
}

std::string percent_encoded(std::string_view name) {
  std::string url;
  for (const char c : name) {
    const bool is_plain = is_ascii_letter_or_digit(c) || c == '-' || c == '.' || c == '_' || c == '~';
    url += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return url;
}

}  // namespace splatlas
