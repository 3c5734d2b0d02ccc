#include "preprocess/import/itk_call.h"

#include <cctype>

namespace splatlas {
namespace {

/// "itk::ERROR: NiftiImageIO(0x55d0c0): Cannot read" -> "Cannot read".
std::string without_origin(const std::string& text) {
  const std::string mark = "itk::ERROR:";
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return text;
  const std::size_t address = text.find("): ", at);
  return text.substr(address == std::string::npos ? at + mark.size() : address + 3);
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
