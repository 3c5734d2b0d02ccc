// Libraries that print when they should return.
#pragma once

namespace splatlas {

/// Nothing reaches standard error while this exists: NIfTI's library and MetaIO print there that they could
/// not read or write, which their callers are told, or find out by reading the file back. It counts for the
/// whole process.
class QuietStandardError {
 public:
  QuietStandardError();
  ~QuietStandardError();
  QuietStandardError(const QuietStandardError&) = delete;
  QuietStandardError& operator=(const QuietStandardError&) = delete;

 private:
  int kept_;  // the descriptor of standard error, or negative when there is none
};

}  // namespace splatlas
