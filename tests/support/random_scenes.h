// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/polygons.h"

namespace vdb_offset::test {

/// A shape and a distance to offset it by, made up from a seed.
struct RandomScene {
  Polygons mesh;
  double distance;
  bool closed;
};
RandomScene random_scene(unsigned seed);

/// A closed box of side 1 whose vertices are moved at random, by up to nine tenths of an edge along each axis: it is
/// folded, and crosses itself all over.
Polygons crumpled_box(unsigned seed);

/// The seeds to try: `count` of them, but at most VDB_OFFSET_RANDOM_MOST, from 1 on, if VDB_OFFSET_RANDOM_COUNT and
/// VDB_OFFSET_RANDOM_FIRST say nothing else.
struct Seeds {
  unsigned first, end;
};
Seeds random_seeds(unsigned count);

}  // namespace vdb_offset::test
