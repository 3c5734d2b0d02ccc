#include "tests/fuzz/require.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

namespace splatlas {

void require(bool holds, std::string_view what) {
  if (holds) return;
  fmt::print(stderr, "finding: {}\n", what);
  std::abort();
}

void require_error(const Error& error, std::initializer_list<ErrorCode> codes) {
  require(std::ranges::find(codes, error.code) != codes.end(),
          fmt::format("error of kind {}: {}", static_cast<int>(error.code), error.message));
  require(!error.message.empty(), "an error without a message");
}

}  // namespace splatlas
