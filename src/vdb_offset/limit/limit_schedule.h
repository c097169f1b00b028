#pragma once

#include <cstddef>
#include <span>

#include "vdb_offset/base/index_set.h"
#include "vdb_offset/limit/untangle.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

// Patches are tried in these ways, the first to its end, with ever more rings around what is wrong. What frees one
// patch fails in the next; borders leave their planes only for what else does not free. The last ways are for small
// patches in which little has collided: these cost next to nothing, and one of several ways frees many of them. Patches
// of more vertices than so many, or in which more have collided, are left out: of 23,000 patches of fifteen models
// these took more than half of the time, and hardly any of them was freed. Larger meshes than all of those may have
// patches as many times larger as they have kManyVertices, rounded up.
// Where faces stay wrong so many times over in the first way, fronts have run through each other, and there is no way
// out: of 380 such patches, which took almost half of the time on thirteen models, two were freed.
inline constexpr std::size_t kAnyNumber = kNone, kManyVertices = 200000;
inline constexpr std::size_t kHopelessVertices = 100,
                             kHopelessCorners = 8;  // more of the latter for each of the former
struct Growth {
  int rings;
  std::size_t most_vertices, most_collided = kAnyNumber;
};
struct UntangleSetting {
  Untangler::Options options;
  std::span<const Growth> growths;
  /// Only patches in which one vertex has so many times as much area around it as another, and which this frees of all
  /// that is wrong.
  double least_contrast = 0;
};
inline constexpr Growth kFarGrowths[] = {{1, kAnyNumber}, {2, 5000},     {3, 5000},      {4, 3000, 40},
                                         {6, 3000, 40},   {8, 3000, 40}, {12, 3000, 40}, {16, 3000, 40}};
inline constexpr Growth kLessGrowths[] = {{1, 1000}, {2, 1000}, {3, 1000}, {4, 1000, 40}, {6, 1000, 40}, {8, 1000, 40}};
inline constexpr Growth kNearGrowths[] = {{1, 1000}, {2, 1000}, {3, 1000}};
inline constexpr Growth kNearestGrowths[] = {{1, 300}, {2, 300}, {3, 300}};
inline constexpr Growth kHopefulGrowths[] = {{1, 1000, 20}, {2, 1000, 20}};
inline constexpr Growth kSmoothGrowths[] = {{1, 1000, 20}, {2, 1000, 20}, {4, 1000, 3}, {6, 1000, 3}};
inline constexpr Growth kSliverGrowths[] = {{1, 300}, {2, 300}, {3, 300}, {4, 300}, {6, 300}};
inline constexpr double kContrast = 30;
inline constexpr UntangleSetting kSchedule[] = {{{1, 4, true, true}, kFarGrowths},
                                                {{0.1, 10, true}, kNearGrowths},
                                                {{1, 30, false}, kLessGrowths},
                                                {{0.01, 10, false}, kNearestGrowths},
                                                {{1, 60, false}, kSmoothGrowths},
                                                {{1, 10, true}, kHopefulGrowths},
                                                {{0.3, 2, true}, kHopefulGrowths},
                                                {{3, 4, true}, kHopefulGrowths},
                                                {{0.03, 30, true}, kHopefulGrowths},
                                                {{1, 2, true}, kHopefulGrowths},
                                                {{0.1, 4, false}, kHopefulGrowths},
                                                {{1, 4, true, true, 0.5}, kSliverGrowths, kContrast},
                                                {{1, 4, true, true, 1}, kSliverGrowths, kContrast},
                                                {{1, 30, false, true, 0.5}, kSliverGrowths, kContrast}};

// Then what has collided is tried in these, with so many rings around. If it is much, and one of them leaves more than
// this share of it where it is, fronts have met, and there is no way out.
struct Freeing {
  Untangler::Options options;
  Growth growth;
};
inline constexpr Freeing kFreeings[] = {{{1, 30, true}, {1, kAnyNumber}},
                                        {{1, 4, true, true}, {0, kAnyNumber}},
                                        {{1, 30, true}, {0, kAnyNumber}},
                                        {{1, 30, false}, {0, 300}},
                                        {{0.01, 10, false}, {0, 300}}};
inline constexpr double kHopeless = 0.99;

// What is in the way of a vertex that is put where there is room slides aside in these, one after the other, with so
// many rings around. Of the first two each frees four times as many as of the others.
struct Aside {
  Untangler::Options options;
  int rings;
};
inline constexpr Aside kAsides[] = {
    {{1, 4, true, true}, 1}, {{1, 4, true, true, 0.5}, 1}, {{1, 30, false}, 1}, {{0.1, 10, true}, 1}};

}  // namespace vdb_offset
