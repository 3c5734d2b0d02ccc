// Matcher of failed results, and names of those that tests use most.
#pragma once

#include <gmock/gmock.h>

#include "format/result.h"

namespace splatlas {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

/// A result that is an error of this code. `message` matches its message.
MATCHER_P2(FailsWith, code, message, "") {
  if (!arg) *result_listener << arg.error().message;
  return !arg && arg.error().code == code &&
         testing::ExplainMatchResult(message, arg.error().message, result_listener);
}

}  // namespace splatlas
