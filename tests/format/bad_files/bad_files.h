// Tables of bad files: each row is the good atlas with one thing changed, and what is said about it.
#pragma once

#include <span>
#include <string>

#include "tests/format/bad_files/raw_atlas.h"

namespace splatlas {

struct BadFile {
  const char* what;
  void (*change)(RawAtlas& atlas);
  const char*
      message;  ///< of opening, or else of verifying; the file's name is F. "": a good file all the same
};

/// Opens and verifies each file: the message must be exactly the row's, the exit status that of an invalid
/// atlas. Reading everything that can be read must do no harm either way.
void expect_refused(std::span<const BadFile> files);

/// A file of these bytes: the message of opening or verifying it; "" for a good one.
[[nodiscard]] std::string fault_of_file(Bytes bytes);

}  // namespace splatlas
