#include "player/web/page_files.h"

// Defines NAME(), the bytes of files, with SPLATLAS_AND between them, which the assembler includes.
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
  std::string_view splatlas::name() {                                                    \
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
#ifdef SPLATLAS_WEB_MODULE_GZIP
SPLATLAS_EMBED(web_module_gzip, SPLATLAS_WEB_MODULE_GZIP)
#else
std::string_view splatlas::web_module_gzip() {
  return {};
}
#endif
