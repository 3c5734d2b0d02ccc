#include "preprocess/import/images/itk/itk_call.h"

#include "preprocess/import/import_error.h"

namespace splatlas {

std::string message_of(const itk::ExceptionObject& error) {
  // "ITK ERROR: NiftiImageIO(0x55d0c0): Cannot read" -> "Cannot read".
  std::string text = error.GetDescription();
  for (const std::string mark : {"itk::ERROR:", "ITK ERROR:"}) {
    if (const std::size_t at = text.find(mark); at != std::string::npos) text.erase(0, at + mark.size());
  }
  const std::size_t address = text.find("(0x");
  const std::size_t end = address == std::string::npos ? address : text.find("): ", address);
  if (end != std::string::npos) text.erase(0, end + 3);
  // The library of NRRD appends its call stack: the last line, "[nrrd] function: cause", has the cause.
  if (const std::size_t last = text.rfind("[nrrd] "); last != std::string::npos) {
    const std::size_t cause = text.find(": ", last);
    text = cause == std::string::npos ? "" : text.substr(cause + 2);
    return one_line(text, "cannot be read") + "; sizes, type and encoding in its header must fit its pixels";
  }
  return one_line(text, "ITK gives no reason");
}

}  // namespace splatlas
