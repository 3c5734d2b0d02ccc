#include "player/web/page_files.h"

// Defines NAME(), the bytes of a file, which the assembler includes.
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
  namespace {                                                                            \
  std::string_view name() {                                                              \
    return {splatlas_##name##_begin,                                                     \
            static_cast<std::size_t>(splatlas_##name##_end - splatlas_##name##_begin)};  \
  }                                                                                      \
  }

SPLATLAS_EMBED(html, SPLATLAS_WEB_FOLDER "/page/page.html")
SPLATLAS_EMBED(css, SPLATLAS_WEB_FOLDER "/page/page.css")
SPLATLAS_EMBED(catalogue_html, SPLATLAS_WEB_FOLDER "/page/catalogue.html")
SPLATLAS_EMBED(catalogue_css, SPLATLAS_WEB_FOLDER "/page/catalogue.css")
SPLATLAS_EMBED(camera_js, SPLATLAS_WEB_FOLDER "/page/camera.js")
SPLATLAS_EMBED(model_js, SPLATLAS_WEB_FOLDER "/page/model.js")
SPLATLAS_EMBED(engine_js, SPLATLAS_WEB_FOLDER "/page/engine.js")
SPLATLAS_EMBED(stage_js, SPLATLAS_WEB_FOLDER "/page/stage.js")
SPLATLAS_EMBED(tree_js, SPLATLAS_WEB_FOLDER "/page/tree.js")
SPLATLAS_EMBED(panels_js, SPLATLAS_WEB_FOLDER "/page/panels.js")
SPLATLAS_EMBED(talk_js, SPLATLAS_WEB_FOLDER "/page/talk.js")
SPLATLAS_EMBED(lesson_js, SPLATLAS_WEB_FOLDER "/page/lesson.js")
SPLATLAS_EMBED(quiz_js, SPLATLAS_WEB_FOLDER "/page/quiz.js")
SPLATLAS_EMBED(slices_js, SPLATLAS_WEB_FOLDER "/page/slices.js")
SPLATLAS_EMBED(page_js, SPLATLAS_WEB_FOLDER "/page/page.js")
SPLATLAS_EMBED(splatlas_js, SPLATLAS_WEB_FOLDER "/splatlas.js")
SPLATLAS_EMBED(worker_js, SPLATLAS_WEB_FOLDER "/page/worker.js")
#ifdef SPLATLAS_WEB_MODULE_GZIP
SPLATLAS_EMBED(module_gzip, SPLATLAS_WEB_MODULE_GZIP)
#endif

namespace splatlas {

std::string_view page_template() {
  return html();
}

std::string_view page_style() {
  return css();
}

std::string_view catalogue_template() {
  return catalogue_html();
}

std::string_view catalogue_style() {
  return catalogue_css();
}

std::string page_script() {
  std::string script;
  for (const std::string_view part : {camera_js(), model_js(), engine_js(), stage_js(), tree_js(),
                                      panels_js(), talk_js(), lesson_js(), quiz_js(), slices_js(), page_js()})
    script += part;
  return script;
}

std::string worker_script() {
  return std::string(splatlas_js()) + std::string(worker_js());
}

std::string_view web_module_gzip() {
#ifdef SPLATLAS_WEB_MODULE_GZIP
  return module_gzip();
#else
  return {};
#endif
}

}  // namespace splatlas
