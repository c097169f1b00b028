// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <stdexcept>
#include <string>
#include <vector>

#include "vdb_offset/io/documents/cad/cad_mesh.h"

namespace vdb_offset::cad {

/// A file that is not what it ought to be: `expected X, got Y`.
struct InvalidCad : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A face of a model, where it is placed.
struct BodyFace {
  TopoDS_Face face;
  io::CadFaceFacts facts;
  bool is_left_out = false;  ///< It has no triangles, and its neighbours are sewn to each other.
};

/// Faces that may share edges: those of a solid, or all those of the file that are of none.
struct Body {
  bool is_solid = false;
  std::vector<BodyFace> faces;  ///< In the order of the file.
};

/// What a CAD file holds.
struct CadModel {
  std::vector<Body> bodies;
  double unit_micrometres = 1000;
  bool has_unit = false;
  double tolerance = 0;  ///< How exact the file says that its coordinates are, in its unit; 0: it does not say.
  std::vector<std::string> extras, remarks;
};

/// Reads a file. \pre format is step, iges or brep \throw InvalidCad
CadModel read_model(const std::string& path, const std::string& format);

}  // namespace vdb_offset::cad
