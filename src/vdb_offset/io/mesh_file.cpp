#include "vdb_offset/io/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "vdb_offset/error.h"
#include "vdb_offset/file_replace.h"
#include "vdb_offset/io/formats.h"
#include "vdb_offset/io/scanner.h"
#include "vdb_offset/triangulate.h"

namespace vdb_offset::io {
namespace {

std::string read_bytes(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) throw ReadError(path + ": expected a file, got a folder");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) throw ReadError(fmt::format("{}: cannot be opened: {}", path, std::strerror(errno)));
  std::string bytes;
  const auto size = std::filesystem::file_size(path, unknown);
  if (!unknown) bytes.reserve(size + 1);
  constexpr std::size_t kChunk = 1 << 20;
  for (std::size_t got = kChunk; got == kChunk;) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kChunk);
    got = std::fread(bytes.data() + before, 1, kChunk, file.get());
    bytes.resize(before + got);
  }
  if (std::ferror(file.get())) throw ReadError(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
  return bytes;
}

void append_number(std::string& text, double value) {
  char digits[32];
  const auto end = std::to_chars(std::begin(digits), std::end(digits), value).ptr;
  text.append(digits, end);
}

/// What a binary file can hold of a number.
double as_stored(double value, std::uint8_t bytes) {
  return bytes == 4 ? static_cast<double>(static_cast<float>(value)) : value;
}

std::vector<Vec3d> as_stored(std::span<const Vec3d> positions, std::uint8_t bytes) {
  std::vector<Vec3d> stored(positions.begin(), positions.end());
  if (bytes == 4)
    for (Vec3d& p : stored) p = Vec3d(as_stored(p[0], 4), as_stored(p[1], 4), as_stored(p[2], 4));
  return stored;
}

/// One number of the file that gets another value.
struct Patch {
  std::uint64_t at;
  double value;
  std::uint8_t bytes;  // 0 for text
};

/// Normals of the file that belong to faces of which a corner moved, computed from the new positions: the sum, over
/// the corners that name a normal, of the corner's face normal times its angle.
class NormalUpdate {
 public:
  NormalUpdate(const MeshFile& source, std::span<const Vec3d> positions, const std::vector<std::uint8_t>& moved)
      : source_(source), positions_(positions) {
    sum_.assign(source.normal_at.size(), Vec3d(0.0));
    affected_.assign(source.normal_at.size(), 0);
    const PolygonView mesh = source.polygons.view();
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.face(f);
      const bool face_moved = std::any_of(face.begin(), face.end(), [&](auto v) { return moved[v] != 0; });
      for (std::size_t k = 0; k < face.size(); ++k) add_corner(f, k, face, face_moved);
    }
  }

  template <class Emit>
  void for_each(Emit&& emit) const {
    for (std::size_t n = 0; n < sum_.size(); ++n)
      if (affected_[n] && sum_[n].lengthSqr() > 0) emit(n, sum_[n].unit());
  }

 private:
  std::uint32_t normal_of(std::size_t face, std::size_t corner, std::uint32_t vertex) const {
    if (source_.format == Format::Stl) return static_cast<std::uint32_t>(face);
    if (source_.format == Format::Obj)
      return source_.corner_normal.empty() ? kNoNormal
                                           : source_.corner_normal[source_.polygons.face_begin[face] + corner];
    return vertex;
  }
  void add_corner(std::size_t f, std::size_t k, std::span<const std::uint32_t> face, bool face_moved) {
    const std::uint32_t normal = normal_of(f, k, face[k]);
    if (normal == kNoNormal) return;
    const Vec3d& tip = positions_[face[k]];
    const Vec3d next = positions_[face[(k + 1) % face.size()]] - tip,
                previous = positions_[face[(k + face.size() - 1) % face.size()]] - tip, across = next.cross(previous);
    const double sine = across.length();
    if (sine > 0) sum_[normal] += across * (std::atan2(sine, next.dot(previous)) / sine);
    affected_[normal] |= face_moved;
  }

  const MeshFile& source_;
  std::span<const Vec3d> positions_;
  std::vector<Vec3d> sum_;
  std::vector<std::uint8_t> affected_;
};

std::vector<Patch> find_patches(const MeshFile& source, std::span<const Vec3d> positions) {
  const std::vector<Vec3d> stored = as_stored(positions, source.position_bytes);
  std::vector<Patch> patches;
  std::vector<std::uint8_t> moved(stored.size(), 0);
  for (std::size_t v = 0; v < stored.size(); ++v) {
    if (stored[v] == source.polygons.positions[v]) continue;
    moved[v] = 1;
    for (int k = 0; k < 3; ++k) patches.push_back({source.position_at[v].at[k], stored[v][k], source.position_bytes});
  }
  if (!source.normal_at.empty())
    NormalUpdate(source, stored, moved).for_each([&](std::size_t n, const Vec3d& normal) {
      for (int k = 0; k < 3; ++k)  // a normal needs no more digits than a float has
        patches.push_back({source.normal_at[n].at[k], as_stored(normal[k], 4), source.normal_bytes});
    });
  const auto by_place = [](const Patch& a, const Patch& b) { return a.at < b.at; };
  if (!std::is_sorted(patches.begin(), patches.end(), by_place)) std::sort(patches.begin(), patches.end(), by_place);
  return patches;
}

bool ends_number(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f' || c == '\\' || c == '#';
}

std::string patch_text(const std::string& bytes, const std::vector<Patch>& patches) {
  std::string text;
  text.reserve(bytes.size() + patches.size() * 12);
  std::size_t copied = 0;
  for (const Patch& patch : patches) {
    text.append(bytes, copied, patch.at - copied);
    append_number(text, patch.value);
    for (copied = patch.at; copied < bytes.size() && !ends_number(bytes[copied]);) ++copied;
  }
  return text.append(bytes, copied);
}

std::string patch_binary(std::string bytes, const std::vector<Patch>& patches, Encoding encoding) {
  for (const Patch& patch : patches) {
    char raw[8];
    const auto narrow = static_cast<float>(patch.value);
    if (patch.bytes == 4) std::memcpy(raw, &narrow, 4);
    else std::memcpy(raw, &patch.value, 8);
    if (encoding == Encoding::BigEndian) std::reverse(raw, raw + patch.bytes);
    std::memcpy(bytes.data() + patch.at, raw, patch.bytes);
  }
  return bytes;
}

template <class T>
void append_binary(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

void append_positions(std::string& text, std::string_view keyword, std::span<const Vec3d> positions) {
  for (const Vec3d& p : positions) {
    text += keyword;
    for (int k = 0; k < 3; ++k) {
      if (k > 0) text += ' ';
      append_number(text, p[k]);
    }
    text += '\n';
  }
}

std::string to_obj(PolygonView mesh) {
  std::string text;
  append_positions(text, "v ", mesh.positions);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    text += 'f';
    for (const auto v : mesh.face(f)) text += ' ' + std::to_string(v + 1);
    text += '\n';
  }
  return text;
}

std::string to_off(PolygonView mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.positions.size(), mesh.face_count());
  append_positions(text, "", mesh.positions);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    text += std::to_string(mesh.face(f).size());
    for (const auto v : mesh.face(f)) text += ' ' + std::to_string(v);
    text += '\n';
  }
  return text;
}

std::string to_ply(PolygonView mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
      "property double z\nelement face {}\nproperty list uint uint vertex_indices\nend_header\n",
      mesh.positions.size(), mesh.face_count());
  for (const Vec3d& p : mesh.positions)
    for (int k = 0; k < 3; ++k) append_binary(bytes, p[k]);
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    append_binary(bytes, static_cast<std::uint32_t>(mesh.face(f).size()));
    for (const auto v : mesh.face(f)) append_binary(bytes, v);
  }
  return bytes;
}

std::string to_stl(PolygonView mesh) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) triangulate(mesh.positions, mesh.face(f), triangles);
  const std::vector<Vec3d> stored = as_stored(mesh.positions, 4);
  std::string bytes(80, '\0');
  append_binary(bytes, static_cast<std::uint32_t>(triangles.size()));
  for (const auto& [a, b, c] : triangles) {
    Vec3d normal = (stored[b] - stored[a]).cross(stored[c] - stored[a]);
    if (normal.length() > 0) normal /= normal.length();
    for (const Vec3d& row : {normal, stored[a], stored[b], stored[c]})
      for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(row[k]));
    append_binary(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string encode(Format format, PolygonView mesh) {
  switch (format) {
    case Format::Obj:
      return to_obj(mesh);
    case Format::Off:
      return to_off(mesh);
    case Format::Ply:
      return to_ply(mesh);
    case Format::Stl:
      break;
  }
  return to_stl(mesh);
}

Format require_format(const std::string& path) {
  const auto format = format_of(path);
  if (!format) throw InvalidInput(path + ": expected a name that ends in .obj, .off, .ply or .stl");
  return *format;
}

/// What stays behind when a file becomes one of another format.
std::string lost_on_conversion(const MeshFile& source, Format target) {
  std::vector<std::string> lost = source.extras;
  if (target == Format::Stl && source.format != Format::Stl) {
    lost.emplace_back("shared vertices");
    const auto& begin = source.polygons.face_begin;
    for (std::size_t f = 0; f + 1 < begin.size(); ++f)
      if (begin[f + 1] - begin[f] > 3) {
        lost.emplace_back("faces of more than three corners (split into triangles)");
        break;
      }
    lost.emplace_back("digits beyond single precision");
  }
  return fmt::format("{}", fmt::join(lost, ", "));
}

}  // namespace

std::optional<Format> format_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  for (const Format format : {Format::Obj, Format::Off, Format::Ply, Format::Stl})
    if (is_word(path.substr(dot + 1), name(format))) return format;
  return std::nullopt;
}

const char* name(Format format) {
  constexpr const char* kNames[] = {"obj", "off", "ply", "stl"};
  return kNames[static_cast<std::size_t>(format)];
}

MeshFile read_mesh(const std::string& path) {
  MeshFile file;
  file.path = path;
  file.format = require_format(path);
  file.bytes = read_bytes(path);
  if (file.bytes.empty()) throw InvalidInput(path + ", byte 0: expected a mesh, got an empty file");
  switch (file.format) {
    case Format::Obj:
      parse_obj(file);
      break;
    case Format::Off:
      parse_off(file);
      break;
    case Format::Ply:
      parse_ply(file);
      break;
    case Format::Stl:
      parse_stl(file);
      break;
  }
  return file;
}

std::string write_mesh(const std::string& path, const MeshFile& source, std::span<const Vec3d> positions,
                       const std::function<void()>& before_rename) {
  const Format format = require_format(path);
  if (format != source.format) {
    write_file(path, encode(format, {positions, source.polygons.corners, source.polygons.face_begin}), before_rename);
    return lost_on_conversion(source, format);
  }
  const std::vector<Patch> patches = find_patches(source, positions);
  write_file(path,
             source.encoding == Encoding::Ascii ? patch_text(source.bytes, patches)
                                                : patch_binary(source.bytes, patches, source.encoding),
             before_rename);
  return {};
}

bool rounds_to_floats(const std::string& path, const MeshFile& source) {
  const Format format = require_format(path);
  if (format != source.format) return format == Format::Stl;
  return source.encoding != Encoding::Ascii && source.position_bytes == 4;
}

void write_mesh(const std::string& path, PolygonView polygons, const std::function<void()>& before_rename) {
  write_file(path, encode(require_format(path), polygons), before_rename);
}

}  // namespace vdb_offset::io
