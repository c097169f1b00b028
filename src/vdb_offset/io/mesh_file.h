#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/polygons.h"
#include "vdb_offset/progress.h"

namespace vdb_offset::io {

enum class Format { Obj, Off, Ply, Stl };

/// The format that a file name's ending stands for (.obj .off .ply .stl, any case), if it does.
std::optional<Format> format_of(std::string_view path);
const char* name(Format format);

/// How the numbers of a PLY or STL file are stored.
enum class Encoding { Ascii, LittleEndian, BigEndian };

/// Where the three numbers of a point or a normal stand in a file's bytes.
struct NumberTriple {
  std::uint64_t at[3];
};

/// A mesh as read, with all that is needed to write the same file again with other coordinates.
struct MeshFile {
  std::string path;
  Format format = Format::Obj;
  Encoding encoding = Encoding::Ascii;
  std::string bytes;  ///< The whole file.
  Polygons polygons;

  /// First byte of each coordinate of each vertex, in the order of `polygons.positions`.
  std::vector<NumberTriple> position_at;
  /// The same for the file's normals, in their own order. OBJ: `vn` lines; OFF, PLY: one a vertex; STL: one a facet.
  std::vector<NumberTriple> normal_at;
  /// OBJ: the normal that each face corner names, kNoNormal where it names none. Empty if no corner does.
  std::vector<std::uint32_t> corner_normal;
  std::vector<std::string> extras;                    ///< What the file holds besides positions and faces, in words.
  std::uint8_t position_bytes = 0, normal_bytes = 0;  ///< Size of a binary number: 4 or 8; 0 for text.
};
inline constexpr std::uint32_t kNoNormal = 0xffffffff;

/// Reads .obj, .off, .ply or .stl, by the file's ending; STL gives three vertices a facet.
/// \throw ReadError if the file cannot be opened, InvalidInput (file, line or byte, what was expected, what was
/// found) for content that is no mesh. Never allocates more than a small multiple of the file's size.
MeshFile read_mesh(const std::string& path);

/// Writes the mesh with other positions to `path`, through a temporary file that is renamed at the end.
/// In the source's own format every byte stays but for the coordinates of vertices that moved and the normals of
/// faces that moved, which are computed anew from the coordinates as written. In another format the file holds
/// the positions and faces (STL: triangles). Returns what the target cannot hold, in words; empty if nothing.
/// Text numbers have the fewest digits that read back to the same double; binary ones keep the source's width.
/// `before_rename` runs when the file is complete and not yet in place; if it throws, nothing is.
/// \pre one position a vertex. \throw InvalidInput for an unknown ending, WriteError.
std::string write_mesh(const std::string& path, const MeshFile& source, std::span<const Vec3d> positions,
                       const std::function<void()>& before_rename = {});

/// Whether write_mesh() would store the positions as 32-bit floats there.
bool rounds_to_floats(const std::string& path, const MeshFile& source);

/// Writes plain polygons, for meshes that come from no file. PLY: binary, doubles. STL: binary, triangles.
void write_mesh(const std::string& path, PolygonView polygons, const std::function<void()>& before_rename = {});

}  // namespace vdb_offset::io
