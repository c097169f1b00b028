// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <string>

namespace vdb_offset::io {

/// While one lives, VTK prints nothing, and the first thing that it has to say is kept. Where it is said is one for the
/// whole program, and is put back.
class VtkComplaint {
 public:
  VtkComplaint();
  VtkComplaint(const VtkComplaint&) = delete;
  VtkComplaint& operator=(const VtkComplaint&) = delete;
  ~VtkComplaint();

  bool empty() const;
  /// In one line, without the place in VTK's source.
  std::string in_short() const;

 private:
  class Window;

  vtkSmartPointer<vtkOutputWindow> before_;
  vtkSmartPointer<Window> window_;
  vtkLogger::Verbosity verbosity_;
};

}  // namespace vdb_offset::io
