// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>

// Solids whose offsets have another topology.

/// A block of 30 x 20 x 15 all of whose edges are rounded by 3.
TopoDS_Shape rounded_block();
/// Two cubes of 10, joined by a bar of 2 x 2 and 6 long.
TopoDS_Shape dumbbell();
/// A pyramid of twelve sides: radius 10, height 10.
TopoDS_Shape pyramid();
/// A block of 30 x 20 x 15, and a plate of 30 x 20 x 0.5 beside it.
TopoDS_Shape block_and_plate();
/// A cube of 10, three of whose faces lie the other way round.
TopoDS_Shape turned_cube();
/// Two boxes that have a face in one place, each with faces of its own.
TopoDS_Shape touching();
/// Two bars that cross each other at right angles, and a cube beside them.
TopoDS_Shape crossed();
/// A shape and a copy of it that stands on it.
TopoDS_Shape on_top_of_each_other(const TopoDS_Shape& one, double height);
