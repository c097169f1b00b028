// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Face.hxx>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "messages/cad_mesh.h"

namespace vdb_offset::cad {

/// A file that is not what it ought to be: `expected X, got Y`.
struct InvalidCad : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A part or an assembly where it is placed.
struct Place {
  std::optional<std::size_t> above;  ///< The place of the assembly that this is in; an index of CadModel::places.
  std::string instance;              ///< What it is called there.
  std::string usual;                 ///< What it is called wherever that assembly is placed, if that is another name.
  std::string product;               ///< What the part or assembly itself is called.
  bool is_assembly = false;
};

/// A face of a model, where it is placed.
struct BodyFace {
  TopoDS_Face face;
  io::CadFaceFacts facts;
  std::optional<std::size_t> place;  ///< Of its part, an index of CadModel::places, where the file has parts.
  bool is_left_out = false;          ///< It has no triangles, and its neighbours are sewn to each other.
};

/// Faces that may share edges: those of a solid, or all those of the file that are of none.
struct Body {
  bool is_solid = false;
  std::vector<BodyFace> faces;  ///< In the order of the file.
};

/// What a CAD file holds.
struct CadModel {
  std::vector<Body> bodies;
  std::vector<Place> places;  ///< Each after the one above it.
  double unit_micrometres = 1000;
  bool has_unit = false;
  double tolerance = 0;  ///< How exact the file says that its coordinates are, in its unit; 0: it does not say.
  std::vector<std::string> extras, remarks;
};

/// Of each face of a body, the lowest of those in its shell: faces that hang together by edges.
std::vector<std::uint32_t> shells_of(const Body& body);

/// Reads a file. \pre format is step, iges or brep \throw InvalidCad
CadModel read_model(const std::string& path, const std::string& format);

}  // namespace vdb_offset::cad
