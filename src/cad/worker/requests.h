// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "messages/cad_messages.h"
#include "read/cad_model.h"
#include "surface/offset_points.h"
#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {

/// The model that requests are about.
class Requests {
 public:
  /// What a request asks for. \throw InvalidCad, BadMessage and whatever OpenCASCADE throws
  std::string answer(io::CadRequest kind, std::string_view payload);

 private:
  std::string mesh(const io::ReadCad& read);
  std::string distances(std::string_view payload) const;
  std::string offset(std::string_view payload) const;

  std::optional<CadModel> model_;
  std::vector<BodyMesh> meshes_;        ///< Of its bodies.
  std::vector<SidedSurface> surfaces_;  ///< Of the faces, in the order in which they are given.
};

}  // namespace vdb_offset::cad
