// Suppression of messages that libraries print to standard error.
#pragma once

namespace splatlas {

/// Redirects standard error of the whole process to /dev/null during its lifetime. The NIfTI library and
/// MetaIO print errors there that their callers detect and report.
class QuietStandardError {
 public:
  QuietStandardError();
  ~QuietStandardError();
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;

 private:
  int kept_;  // duplicate of standard error, or negative if it was closed
};

}  // namespace splatlas
