// Tables of invalid files: the good atlas with one change per row, and the expected message.
#pragma once

#include <span>
#include <string>

#include "tests/format/bad_files/raw_atlas.h"

namespace splatlas {

struct BadFile {
  const char* what;
  void (*change)(RawAtlas& atlas);
  const char* message;  ///< of opening or else verifying; the file name is F. "": a valid file
};

/// Opens and verifies each file. Expects exactly the message of the row and the exit status of an invalid
/// atlas. Also reads everything that can be read, which must do no harm.
void expect_refused(std::span<const BadFile> files);

/// The message of opening or verifying a file of these bytes; "" for a valid one.
[[nodiscard]] std::string fault_of_file(Bytes bytes);

}  // namespace splatlas
