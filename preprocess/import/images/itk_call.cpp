#include "preprocess/import/images/itk_call.h"

#include <cctype>

namespace splatlas {
namespace {

/// "ITK ERROR: NiftiImageIO(0x55d0c0): Cannot read" -> "Cannot read".
std::string without_origin(std::string text) {
  for (const std::string mark : {"itk::ERROR:", "ITK ERROR:"}) {
    if (const std::size_t at = text.find(mark); at != std::string::npos) text.erase(0, at + mark.size());
  }
  const std::size_t address = text.find("(0x");
  const std::size_t end = address == std::string::npos ? address : text.find("): ", address);
  if (end != std::string::npos) text.erase(0, end + 3);
  return text;
}

}  // namespace

std::string essence(const itk::ExceptionObject& error) {
  const std::string text = without_origin(error.GetDescription());
  std::string line;
  for (const char c : text) {
    const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
  return line.empty() ? "ITK gives no reason" : line;
}

}  // namespace splatlas
