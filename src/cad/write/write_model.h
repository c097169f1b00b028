// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "read/cad_model.h"

namespace vdb_offset::cad {

/// What is written of a model, and what its faces are told to be.
struct WrittenModel {
  std::vector<TopoDS_Shape> shapes;
  std::vector<std::string> names;                    ///< Of each shape; may be empty.
  std::vector<Place> places;                         ///< Those of the source.
  std::vector<std::optional<std::size_t>> place_of;  ///< Of each shape, in these.
  std::vector<std::pair<TopoDS_Shape, io::CadFaceFacts>> faces;
  double millimetres = 1;  ///< Of the file's unit; the shapes are in millimetres.
};

/// Writes a STEP file (AP214), with the names of shapes and faces, assemblies, colours and layers; or a BREP file,
/// which has a place for none of these. `format` is step or brep. \throw InvalidCad if it cannot
void write_model(const WrittenModel& model, const std::string& format, const std::string& path);

}  // namespace vdb_offset::cad
