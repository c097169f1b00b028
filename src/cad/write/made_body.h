// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <gp_Pnt.hxx>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "messages/cad_messages.h"

namespace vdb_offset::cad {

/// What a body has become.
struct MadeBody {
  io::CadWritten facts;              ///< Without the file's bytes.
  std::vector<TopoDS_Shape> shapes;  ///< Solids or shells, in millimetres.
  /// What faces became: their numbers in the body, and faces of the shapes, or compounds of some.
  std::vector<std::pair<std::size_t, TopoDS_Shape>> faces;
  std::vector<gp_Pnt> bad_places;  ///< Where it is not good, if that is known; for the process that made it alone.
  bool may_be_better = false;      ///< Doubtful for what is exact in it: another way may give a good one.
  bool is_good() const { return facts.made != io::CadMade::Nothing; }
};

/// As bytes, for another process.
std::string pack(const MadeBody& made);
MadeBody unpack_body(std::string_view bytes);

}  // namespace vdb_offset::cad
