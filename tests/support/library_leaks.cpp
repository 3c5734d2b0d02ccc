// Leaks of libraries, for LeakSanitizer: ITK's NRRD reader drops its buffers when a read fails, and Pango
// keeps fontconfig's tables.

/// Called by the sanitizer's shared library, so it must be visible there.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();

const char* __lsan_default_suppressions() {
  return "leak:libITKNrrdIO\nleak:libfontconfig\n";
}
