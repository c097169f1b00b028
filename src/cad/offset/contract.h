// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "offset/model.h"

namespace vdb_offset::cad {

/// Joins the ends of edges to one vertex; faces all of whose edges go are gone. False if what meets there would be more
/// than one fan of faces (the model is then of no more use).
bool contract_edges(Model& model, const std::vector<int>& edges);

/// Takes a face out and lets its neighbours meet: a long one becomes the edge between the two neighbours along it, a
/// short one a vertex. False if its border is none of these.
bool remove_face(Model& model, int face);

/// Takes faces out that close a hole (or level a boss): those behind their borders lose whole loops and nothing else,
/// or go, too, if they have no others. False if it is not so; the model is as it was then.
bool close_hole(Model& model, std::vector<int> faces);

/// Takes faces out that part two others, which have passed each other: the walls of a groove round a neck, or the sides
/// of a flange. The narrower of the two goes as well, and what was behind it meets the wider one; if they are as wide
/// as each other both go, and what was behind them meets. Nothing if it is not so; the model is as it was then. False
/// if what meets would be more than one fan of faces.
std::optional<bool> close_neck(Model& model, const std::vector<int>& faces);

/// The edges round a face that have another face behind them, in turn by loops.
std::vector<int> sides_of_face(const Model& model, int face);

}  // namespace vdb_offset::cad
