// Suppression of messages on standard error.
#pragma once

namespace splatlas {

/// Redirects standard error of the whole process to /dev/null during its lifetime. NIfTI's library and MetaIO
/// print errors there that they also return, or that reading the file back finds.
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
