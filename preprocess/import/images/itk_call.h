// Calls into ITK: exceptions become one-line errors here and nowhere else.
#pragma once

#include <exception>
#include <new>
#include <string>

#include <itkMacro.h>

#include "format/result.h"

namespace splatlas {

/// What ITK has to say, in one line: without object addresses, source locations and repeated blanks.
[[nodiscard]] std::string essence(const itk::ExceptionObject& error);

/// Runs `call` (a function that returns a Result). ITK's and the standard library's exceptions become
/// kFailed, exhausted memory kLimit; the message starts with `what`, which names the file or the step.
template <typename Call>
[[nodiscard]] auto call_itk(const std::string& what, Call&& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, what + ": not enough memory");
  } catch (const itk::MemoryAllocationError&) {
    return fail(ErrorCode::kLimit, what + ": not enough memory");
  } catch (const itk::ExceptionObject& error) {
    return fail(ErrorCode::kFailed, what + ": " + essence(error));
  } catch (const std::exception& error) {
    return fail(ErrorCode::kFailed, what + ": " + error.what());
  }
}

}  // namespace splatlas
