// Directories that say something else than they did, each entry on its own.
#pragma once

#include "format/file/directory.h"
#include "tests/fuzz/mutate_number.h"

namespace splatlas {

/// Changes one to three entries, of any table; what they say may be sound or not.
void mutate_directory(Directory& directory, Random& random);

}  // namespace splatlas
