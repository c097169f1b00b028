// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "offset/place.h"

namespace vdb_offset::cad {

/// Places all vertices of a model whose edges are classified. Faces that the distance swallows are taken out, edges
/// that shrink to nothing are contracted and their neighbours meet. Adds what could not be done to `gaps`, in words.
void arrange(Model& model, const Tolerances& tolerances, std::vector<std::string>& gaps);

/// Places all vertices and takes out nothing but faces that have no offset. Edges and faces that are turned round stay,
/// for what crosses to be trimmed: edges then go the other way.
void arrange_turned(Model& model, const Tolerances& tolerances, std::vector<std::string>& gaps);

}  // namespace vdb_offset::cad
