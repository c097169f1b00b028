// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "bytes/obj_lines.h"
#include "vdb_offset/io/mesh_file.h"

// What writers of other faces need to know of an OBJ file's text.
namespace vdb_offset::io {

/// The lines that corners of faces refer to.
enum LineKind : std::size_t { kVLines, kVtLines, kVnLines, kLineKinds };

inline std::size_t kind_of(const ObjLine& line) {
  return line.is("v") ? kVLines : line.is("vt") ? kVtLines : line.is("vn") ? kVnLines : kLineKinds;
}

/// How many lines of each kind, and how many faces, have been read.
struct ObjCounts {
  std::array<std::size_t, kLineKinds> lines{};
  std::size_t faces = 0;
};

/// A statement that holds for the faces after it, and the one that ends it. Groups are not among these, as they also
/// name the part of a shell.
struct FaceState {
  std::string_view keyword, reset;
};
inline constexpr std::size_t kFaceStateCount = 8;
inline constexpr FaceState kFaceStates[kFaceStateCount] = {{"o", ""},
                                                           {"usemtl", "usemtl\n"},
                                                           {"s", "s off\n"},
                                                           {"lod", "lod 0\n"},
                                                           {"usemap", "usemap off\n"},
                                                           {"bevel", "bevel off\n"},
                                                           {"c_interp", "c_interp off\n"},
                                                           {"d_interp", "d_interp off\n"}};
inline constexpr std::size_t kObject = 0, kSmoothGroup = 2, kNoState = kFaceStateCount;

/// Which of them a keyword is, or kNoState.
std::size_t face_state_of(std::string_view keyword);
inline bool is_obj_element(std::string_view keyword) { return keyword == "l" || keyword == "p"; }

/// The statements in force at some point of a file: whole lines, empty where there has been none.
using StateLines = std::array<std::string_view, kFaceStateCount>;

/// A run of lines, as cut_at_lines() cuts them.
struct ObjRun {
  std::size_t begin = 0, end = 0;
  ObjCounts before;
  bool has_groups = false, has_elements = false;
  /// In force before the run: statements that come later in the file are ended.
  StateLines state;
};

/// The runs of a file, and what is known of the whole file.
struct ObjRuns {
  std::vector<ObjRun> runs;
  StateLines state_at_end;
  bool groups_late = true;   ///< The first face is in no group.
  bool objects_late = true;  ///< The first face is in no object.
  std::size_t first_face_run = 0;
  std::array<std::size_t, kLineKinds> last_end{};  ///< Of each kind of lines: the byte behind the last one.
  std::vector<std::uint64_t> texture_at;           ///< Of each vt line: the byte behind the keyword.
  std::vector<std::uint32_t> corner_texture;       ///< Of each corner; empty if none has texture coordinates.
  bool names_unknown_texture = false;              ///< A corner names texture coordinates that are not there.
};

/// Scans the file in parallel. Views refer to its text.
ObjRuns find_obj_runs(const MeshFile& source);

}  // namespace vdb_offset::io
