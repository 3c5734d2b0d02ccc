// Mutations of single directory entries.
#pragma once

#include "format/file/directory.h"
#include "tests/fuzz/mutate_number.h"

namespace splatlas {

/// Changes one to three entries of any table, to valid or invalid values.
void mutate_directory(Directory& directory, Random& random);

}  // namespace splatlas
