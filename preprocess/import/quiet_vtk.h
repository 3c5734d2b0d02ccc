// VTK without its messages on standard error, and its reader of XML.
#pragma once

#include <string>

#include <vtkAlgorithm.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>

namespace splatlas {

/// Initialises VTK's object factories, and silences its output window in this process. VTK's own at its first
/// object is not thread-safe: call this before threads use VTK. Thread-safe; only the first call acts.
void initialize_vtk();

/// Runs filter.Update() and returns VTK's first error or warning, in one line; else empty. Initialises VTK.
[[nodiscard]] std::string update_quietly(vtkAlgorithm& filter);

/// The root of an XML text; null if it is not whole.
[[nodiscard]] vtkSmartPointer<vtkXMLDataElement> parse_xml(const std::string& text);
/// An attribute; empty if there is none.
[[nodiscard]] std::string attribute(vtkXMLDataElement& element, const char* name);
/// The text between the tags of an element; empty for none.
[[nodiscard]] std::string text_of(vtkXMLDataElement* element);

}  // namespace splatlas
