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

}  // namespace vdb_offset::test
