// Release of memory that is needed no longer.
#pragma once

#include <vector>

namespace splatlas {

/// Empties a vector and frees its memory, which `vector = {}` keeps.
template <typename T>
void free_memory(std::vector<T>& vector) {
  std::vector<T>().swap(vector);
}

}  // namespace splatlas
