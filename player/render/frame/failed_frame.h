// Errors of frames.
#pragma once

#include <new>
#include <string>

#include "format/result.h"
#include "format/tasks/task_control.h"

namespace splatlas {

/// The result of body(), the work of a public function, with the exceptions of its task as errors. Errors
/// other than kUsage, which are about options, name the atlas.
template <typename Body>
[[nodiscard]] auto as_errors_of(const std::string& atlas, const Body& body) -> decltype(body()) {
  const auto named = [&](ErrorCode code, const std::string& message) {
    return tl::unexpected(Error{code, atlas + ": " + message, atlas});
  };
  try {
    auto result = body();
    if (result || result.error().code == ErrorCode::kUsage || !result.error().subject.empty()) return result;
    return named(result.error().code, result.error().message);
  } catch (const OverBudget& over) {
    return tl::unexpected(over.error());
  } catch (const Cancelled&) {
    return named(ErrorCode::kCancelled, "rendering was cancelled");
  } catch (const std::bad_alloc&) {
    return named(ErrorCode::kLimit, "out of memory; take a smaller size or select less");
  }
}

}  // namespace splatlas
