// Names files of writers that leave them unnamed.
#pragma once

#include "format/io/output_file.h"

namespace splatlas {

/// The result of commit_files(), or the error before it.
inline Result<void> committed(Result<OutputFile> file) {
  if (file) return commit_files({&*file, 1});
  return tl::unexpected(file.error());
}

}  // namespace splatlas
