// Matcher of failed results.
#pragma once

#include <gmock/gmock.h>

#include "format/result.h"

namespace splatlas {

/// A result that is an error of this code. `message` matches its message.
MATCHER_P2(FailsWith, code, message, "") {
  if (!arg) *result_listener << arg.error().message;
  return !arg && arg.error().code == code &&
         testing::ExplainMatchResult(message, arg.error().message, result_listener);
}

}  // namespace splatlas
