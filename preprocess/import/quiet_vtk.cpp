#include "preprocess/import/quiet_vtk.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <utility>

#include <vtkCallbackCommand.h>
#include <vtkErrorCode.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkXMLUtilities.h>

#include "format/text/ascii_text.h"

namespace splatlas {
namespace {

/// First message of VTK since update_quietly began, on this thread.
thread_local std::string first_complaint;

/// "ERROR: In file.cxx, line 9\nvtkSTLReader (0x55): Cannot read\n\n" -> "Cannot read".
std::string message_of(const char* text) {
  std::string message = text != nullptr ? text : "";
  if (const std::size_t place = message.find(", line "); place != std::string::npos) {
    message.erase(0, std::min(message.find('\n', place), message.size()));
  }
  if (const std::size_t address = message.find("): "); address != std::string::npos)
    message.erase(0, address + 3);
  return one_line(message, "VTK gives no reason");
}

void remember(const char* text) {
  if (first_complaint.empty()) first_complaint = message_of(text);
}

/// Receives messages of VTK's inner objects.
class SilentWindow : public vtkOutputWindow {
 public:
  static SilentWindow* New();
  vtkTypeMacro(SilentWindow, vtkOutputWindow) void DisplayText(const char* text) override { remember(text); }
};
vtkStandardNewMacro(SilentWindow);

}  // namespace

void initialize_vtk() {
  static std::once_flag once;
  std::call_once(once, [] {
    vtkObjectFactory::GetRegisteredFactories();
    vtkNew<SilentWindow> window;
    vtkOutputWindow::SetInstance(window);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  });
}

vtkSmartPointer<vtkXMLDataElement> parse_xml(const std::string& text) {
  initialize_vtk();
  return vtk::TakeSmartPointer(vtkXMLUtilities::ReadElementFromString(text.c_str()));
}

std::string attribute(vtkXMLDataElement& element, const char* name) {
  const char* const value = element.GetAttribute(name);
  return value != nullptr ? value : "";
}

std::string text_of(vtkXMLDataElement* element) {
  const char* const text = element != nullptr ? element->GetCharacterData() : nullptr;
  return text != nullptr ? std::string(trimmed(text)) : "";
}

std::string update_quietly(vtkAlgorithm& filter) {
  initialize_vtk();
  first_complaint.clear();
  vtkNew<vtkCallbackCommand> listener;
  listener->SetCallback(
      [](vtkObject*, unsigned long, void*, void* text) { remember(static_cast<const char*>(text)); });
  const unsigned long errors = filter.AddObserver(vtkCommand::ErrorEvent, listener);
  const unsigned long warnings = filter.AddObserver(vtkCommand::WarningEvent, listener);
  try {
    filter.Update();
  } catch (const std::exception& error) {
    remember(error.what());
  }
  filter.RemoveObserver(errors);
  filter.RemoveObserver(warnings);
  if (first_complaint.empty() && filter.GetErrorCode() != vtkErrorCode::NoError) {
    remember(vtkErrorCode::GetStringFromErrorCode(filter.GetErrorCode()));
  }
  return std::move(first_complaint);
}

}  // namespace splatlas
