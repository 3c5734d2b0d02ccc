// Calls of ITK, and conversion of its exceptions, types and grids.
#pragma once

#include <exception>
#include <new>
#include <string>

#include <itkImageIOBase.h>
#include <itkMacro.h>

#include "format/content/grid.h"
#include "format/content/voxel_type.h"
#include "format/io/memory_limit.h"
#include "format/result.h"

namespace splatlas {

/// ITK's message as one line, without object addresses and source locations.
[[nodiscard]] std::string message_of(const itk::ExceptionObject& error);

/// The cause in a call stack of teem, the library of NRRD: the last line, "[nrrd] function: cause". Ends
/// before quoted text of the file, which may name a patient.
[[nodiscard]] std::string message_of_teem(const std::string& stack);

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

/// Voxel type of an ITK component type; kNone for unsupported types such as 64-bit integers.
[[nodiscard]] VoxelType voxel_type_of(itk::IOComponentEnum component);

/// The grid of the file whose header `io` has read. A 2-D image gets a third, orthogonal axis of size 1.
[[nodiscard]] Grid grid_of(const itk::ImageIOBase& io);

}  // namespace splatlas
