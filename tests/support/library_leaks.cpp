// Leaks of libraries, for LeakSanitizer: buffers of ITK's NRRD reader, and tables of fontconfig in Pango.

/// Called by the sanitizer's shared library, so it must be visible there.
extern "C" [[gnu::visibility("default")]] const char* __lsan_default_suppressions();

const char* __lsan_default_suppressions() {
  return "leak:libITKNrrdIO\nleak:libfontconfig\n";
}
