#include "preprocess/import/images/itk_call.h"

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
  return one_line(text, "ITK gives no reason");
}

}  // namespace splatlas
