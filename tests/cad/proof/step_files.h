// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <map>
#include <string>

namespace cad_proof {

/// A STEP file as OpenCASCADE reads it, with its faces by their names.
struct StepFile {
  TopoDS_Shape shape;
  std::map<std::string, TopoDS_Face> faces;
};

/// Writes a shape whose faces are named f1, f2, ... \throw std::runtime_error
void write_step(const TopoDS_Shape& shape, const std::string& path);

/// \throw std::runtime_error
StepFile read_step(const std::string& path);

/// The length of a diagonal of the box that bounds a shape closely.
double diagonal_of(const TopoDS_Shape& shape);
double volume_of(const TopoDS_Shape& shape);

}  // namespace cad_proof
