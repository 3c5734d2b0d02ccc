#include "preprocess/import/quiet_vtk.h"

#include <cctype>
#include <exception>
#include <mutex>

#include <vtkCallbackCommand.h>
#include <vtkErrorCode.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

namespace splatlas {
namespace {

/// Takes what VTK's inner objects would print.
class SilentWindow : public vtkOutputWindow {
 public:
  static SilentWindow* New();
  vtkTypeMacro(SilentWindow, vtkOutputWindow) void DisplayText(const char*) override {}
};
vtkStandardNewMacro(SilentWindow);

void silence() {
  static std::once_flag once;
  std::call_once(once, [] {
    vtkNew<SilentWindow> window;
    vtkOutputWindow::SetInstance(window);
  });
}

/// "ERROR: In file.cxx, line 9\nvtkSTLReader (0x55): Cannot read\n\n" -> "Cannot read".
std::string essence(const char* text) {
  std::string message = text != nullptr ? text : "";
  if (const std::size_t address = message.find("): "); address != std::string::npos)
    message.erase(0, address + 3);
  std::string line;
  for (const char c : message) {
    const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line.empty() ? "VTK gives no reason" : line;
}

void remember_first(vtkObject*, unsigned long, void* client, void* text) {
  auto& message = *static_cast<std::string*>(client);
  if (message.empty()) message = essence(static_cast<const char*>(text));
}

}  // namespace

std::string update_quietly(vtkAlgorithm& filter) {
  silence();
  std::string message;
  vtkNew<vtkCallbackCommand> listener;
  listener->SetCallback(remember_first);
  listener->SetClientData(&message);
  const unsigned long tag = filter.AddObserver(vtkCommand::ErrorEvent, listener);
  const unsigned long warning_tag = filter.AddObserver(vtkCommand::WarningEvent, listener);
  try {
    filter.Update();
  } catch (const std::exception& error) {
    message = error.what();
  }
  filter.RemoveObserver(tag);
  filter.RemoveObserver(warning_tag);
  if (message.empty() && filter.GetErrorCode() != vtkErrorCode::NoError) {
    message = vtkErrorCode::GetStringFromErrorCode(filter.GetErrorCode());
  }
  return message;
}

}  // namespace splatlas
