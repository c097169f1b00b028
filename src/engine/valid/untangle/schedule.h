// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "ground/numbers/index_set.h"
#include "space/surface/surface.h"
#include "valid/untangle/untangle.h"

/// The schedule of limit(): with which settings of the energy patches are untangled, on which patches, in which order.
/// Measurements are those of docs/dev/tuning.md.
namespace vdb_offset {

inline constexpr std::size_t kAnyNumber = kNone;

/// Which patches of vertices are tried: larger ones are left out, and those in which more vertices have collided. Of
/// 23,000 patches of fifteen models those that are left out took more than half of the time, and hardly any of them was
/// freed.
struct PatchSizes {
  int rings;                               ///< Rings of vertices around faulty faces that the patches are made of.
  std::size_t most_vertices = kAnyNumber;  ///< Of a patch.
  std::size_t most_collided = kAnyNumber;  ///< Vertices of a patch that are short.
};

/// A setting of the untangling energy, and the patches that it is tried on, in this order.
struct UntangleSetting {
  Untangler::Options energy;
  std::span<const PatchSizes> sizes;
};

/// For each so many vertices of a mesh, begun or whole, patches may be larger by PatchSizes::most_vertices: large
/// meshes have large features. Not measured.
inline constexpr std::size_t kManyVertices = 200000;

/// Patches of more than kHopelessVertices vertices, with more than kHopelessCorners faulty corners for each vertex, are
/// given up after the first pass: there fronts have run through each other, and there is no way out. Of 380 such
/// patches, which took almost half of the time on thirteen models, two were freed.
inline constexpr std::size_t kHopelessVertices = 100, kHopelessCorners = 8;

// The limits in these tables: see PatchSizes. Patches of one ring are as small as can be, so that the first setting
// leaves none of them out.
inline constexpr PatchSizes kFarSizes[] = {
    {.rings = 1},
    {.rings = 2, .most_vertices = 5000},
    {.rings = 3, .most_vertices = 5000},
    {.rings = 4, .most_vertices = 3000, .most_collided = 40},
    {.rings = 6, .most_vertices = 3000, .most_collided = 40},
    {.rings = 8, .most_vertices = 3000, .most_collided = 40},
    {.rings = 12, .most_vertices = 3000, .most_collided = 40},
    {.rings = 16, .most_vertices = 3000, .most_collided = 40},
};
inline constexpr PatchSizes kMiddleSizes[] = {
    {.rings = 1, .most_vertices = 1000},
    {.rings = 2, .most_vertices = 1000},
    {.rings = 3, .most_vertices = 1000},
    {.rings = 4, .most_vertices = 1000, .most_collided = 40},
    {.rings = 6, .most_vertices = 1000, .most_collided = 40},
    {.rings = 8, .most_vertices = 1000, .most_collided = 40},
};
inline constexpr PatchSizes kNearSizes[] = {
    {.rings = 1, .most_vertices = 300},
    {.rings = 2, .most_vertices = 300},
    {.rings = 3, .most_vertices = 300},
};

// Small patches in which little has collided cost next to nothing.
inline constexpr PatchSizes kSmallPatchSizes[] = {
    {.rings = 1, .most_vertices = 1000, .most_collided = 20},
    {.rings = 2, .most_vertices = 1000, .most_collided = 20},
};
inline constexpr PatchSizes kSmoothSizes[] = {
    {.rings = 1, .most_vertices = 1000, .most_collided = 20},
    {.rings = 2, .most_vertices = 1000, .most_collided = 20},
    {.rings = 4, .most_vertices = 1000, .most_collided = 3},
    {.rings = 6, .most_vertices = 1000, .most_collided = 3},
};

/// The settings, tried one after the other, each on all of its sizes, until no face is faulty. One setting frees what
/// another cannot, so that the later rows differ from the earlier ones in all of their numbers. Borders leave the plane
/// across them (keep_borders) only in rows for patches that nothing else frees. Seven more rows were worth nothing.
inline constexpr UntangleSetting kSchedule[] = {
    // The most general setting, thorough, on all patches: what it leaves, the others hardly free.
    {.energy = {.area_weight = 1, .smoothing = 4, .keep_borders = true, .thorough = true}, .sizes = kFarSizes},
    // Borders may bend; very smooth normals, for patches around sharp concave creases.
    {.energy = {.area_weight = 1, .smoothing = 30, .keep_borders = false}, .sizes = kMiddleSizes},
    // Almost shapes alone, with bent borders.
    {.energy = {.area_weight = 0.01, .smoothing = 10, .keep_borders = false}, .sizes = kNearSizes},
    // The smoothest normals.
    {.energy = {.area_weight = 1, .smoothing = 60, .keep_borders = false}, .sizes = kSmoothSizes},
    // Weights and smoothings between and beyond those above.
    {.energy = {.area_weight = 1, .smoothing = 10, .keep_borders = true}, .sizes = kSmallPatchSizes},
    {.energy = {.area_weight = 0.3, .smoothing = 2, .keep_borders = true}, .sizes = kSmallPatchSizes},
    {.energy = {.area_weight = 3, .smoothing = 4, .keep_borders = true}, .sizes = kSmallPatchSizes},
};

/// With more faults than this fronts have run through each other, and large patches take long for little: only patches
/// of up to kFewRings rings are tried, and a further setting only if the last one has left less than kWorthwhile of the
/// faults that it began with. Not measured.
inline constexpr std::size_t kManyFaults = 2000;
inline constexpr int kFewRings = 3;
inline constexpr double kWorthwhile = 0.8;

/// With a warm start, patches of more vertices than this are not tried: hardly any of them is freed that was not freed
/// already.
inline constexpr std::size_t kWarmStartVertices = 60;
/// Rings around the vertices that were moved at the farther distance, which start from there as well. Not measured.
inline constexpr int kWarmStartRings = 1;

/// How vertices that have collided are moved to where they have their distance: a setting of the energy, and the
/// patches, of the rings around collided vertices.
struct CollidedSetting {
  Untangler::Options energy;
  PatchSizes sizes;
};
/// Tried in this order, after kSchedule. Three more that once followed gave 0.01 points of vertices.
inline constexpr CollidedSetting kCollidedSchedule[] = {
    {.energy = {.area_weight = 1, .smoothing = 30, .keep_borders = true}, .sizes = {.rings = 1}},
    {.energy = {.area_weight = 1, .smoothing = 4, .keep_borders = true, .thorough = true}, .sizes = {.rings = 0}},
};
/// Where more than kManyFaults vertices have collided, and a setting leaves more than this share of them where they
/// are, fronts have met, and the rest of the schedule is left out: 30 % less time where much has to be repaired, and
/// 0.03 points fewer vertices reach their distance, of 105 runs.
inline constexpr double kGiveUpShare = 0.99;

/// How vertices slide out of the way of a vertex that is settled: a setting of the energy, and the rings around the
/// faulty faces whose vertices slide.
struct SlideAside {
  Untangler::Options energy;
  int rings;
};
/// Tried in this order until one is valid. Of two more, one with longer edges for slivers, and one with shapes that
/// count more, neither was worth its time: 0.04 points of vertices for 5 % of it, and faces that are 0.02 points
/// farther off.
inline constexpr SlideAside kSlideAsides[] = {
    {.energy = {.area_weight = 1, .smoothing = 4, .keep_borders = true, .thorough = true}, .rings = 1},
    {.energy = {.area_weight = 1, .smoothing = 30, .keep_borders = false}, .rings = 1},
};

}  // namespace vdb_offset
