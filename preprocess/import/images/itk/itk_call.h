// Calls of ITK: conversion of its exceptions to errors.
#pragma once

#include <exception>
#include <new>
#include <string>

#include <itkMacro.h>

#include "format/io/memory_limit.h"
#include "format/result.h"

namespace splatlas {

/// ITK's message as one line, without object addresses and source locations.
[[nodiscard]] std::string message_of(const itk::ExceptionObject& error);

/// Runs `call`, a function that returns a Result. Exceptions of ITK and the standard library become kFailed,
/// std::bad_alloc becomes kLimit. Messages start with `what`, the name of the file or the step.
template <typename Call>
[[nodiscard]] auto call_itk(const std::string& what, Call&& call) -> decltype(call()) {
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::kLimit, what + ": out of memory; " + kOutOfMemoryRemedy);
  } catch (const itk::MemoryAllocationError&) {
    return fail(ErrorCode::kLimit, what + ": out of memory; " + kOutOfMemoryRemedy);
  } catch (const itk::ExceptionObject& error) {
    return fail(ErrorCode::kFailed, what + ": " + message_of(error));
  } catch (const std::exception& error) {
    return fail(ErrorCode::kFailed, what + ": " + error.what());
  }
}

}  // namespace splatlas
