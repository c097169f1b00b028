// SPDX-License-Identifier: Apache-2.0
#include "vtk/module/vtk_complaint.h"

#include <cstring>

namespace vdb_offset::io {

class VtkComplaint::Window : public vtkOutputWindow {
 public:
  static Window* New() { return new Window; }
  void DisplayText(const char* said) override {
    // Keys of programs' own are no part of the mesh.
    if (text.empty() && said && !std::strstr(said, "Could not locate key")) text = said;
  }

  std::string text;
};

VtkComplaint::VtkComplaint()
    : before_(vtkOutputWindow::GetInstance()),
      window_(vtkSmartPointer<Window>::Take(Window::New())),
      verbosity_(vtkLogger::GetCurrentVerbosityCutoff()) {
  vtkOutputWindow::SetInstance(window_);
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

VtkComplaint::~VtkComplaint() {
  vtkLogger::SetStderrVerbosity(verbosity_);
  vtkOutputWindow::SetInstance(before_);
}

bool VtkComplaint::empty() const { return window_->text.empty(); }

std::string VtkComplaint::in_short() const {
  std::string text = window_->text.substr(0, window_->text.find_last_not_of(" \n") + 1);
  if (const std::size_t object = text.rfind("): "); object != std::string::npos) text.erase(0, object + 3);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  constexpr std::size_t kMost = 200;  // characters
  return text.substr(0, kMost);
}

}  // namespace vdb_offset::io
