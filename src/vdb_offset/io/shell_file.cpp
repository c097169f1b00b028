#include "vdb_offset/io/shell_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "vdb_offset/error.h"
#include "vdb_offset/io/convert.h"
#include "vdb_offset/io/formats.h"
#include "vdb_offset/io/numbers.h"
#include "vdb_offset/io/scanner.h"
#include "vdb_offset/io/shell_formats.h"

namespace vdb_offset::io {
namespace {

// A normal needs no more.
constexpr Precision kNormalPrecision{Precision::Kind::Single};

void require_same_mesh(const MeshFile& source, const Shell& shell) {
  if (shell.source_vertices() == source.polygons.positions.size() &&
      shell.source_faces() == source.polygons.face_count())
    return;
  throw InvalidInput(fmt::format("write_shell: expected a shell of {} vertices and {} faces, got one of {} and {}",
                                 source.polygons.positions.size(), source.polygons.face_count(),
                                 shell.source_vertices(), shell.source_faces()));
}

Pieces in_own_format(const SharedShell& content, std::vector<std::string>& lost) {
  switch (content->source.format) {
    case Format::Obj:
      return shell_to_obj(content, lost);
    case Format::Off:
      return shell_to_off(content, lost);
    case Format::Ply:
      return shell_to_ply(content, lost);
    case Format::Stl:
      break;
  }
  return shell_to_stl(content, lost);
}

/// A number with the other sign; a word that is none stays.
std::string negated(std::string_view word) {
  double value = 0;
  if (!parse_double(word, value) || value == 0) return std::string(word);
  if (word.starts_with('-')) return std::string(word.substr(1));
  return "-" + std::string(word.substr(word.starts_with('+') ? 1 : 0));
}

}  // namespace

Skin::Skin(const MeshFile& source, const Shell& shell, ShellPart part, const Precision& precision, Normals normals)
    : source_(source),
      positions_(part == ShellPart::Inner ? shell.inner() : shell.outer()),
      first_vertex_(part == ShellPart::Inner ? static_cast<std::uint32_t>(positions_.size()) : 0),
      precision_(precision) {
  if (normals == Normals::Recompute) normals_ = io::new_normals(source, positions_, precision);
}

bool Skin::is_source() const {
  return std::equal(positions_.begin(), positions_.end(), source_.polygons.positions.begin());
}

Vec3d Skin::position(std::size_t v) const { return new_position(v).value_or(source_.polygons.positions[v]); }

std::optional<Vec3d> Skin::new_position(std::size_t v) const {
  if (!has_moved(source_.polygons.positions[v], positions_[v], precision_)) return std::nullopt;
  return precision_(positions_[v]);
}

std::optional<Vec3d> Skin::new_normal(std::size_t n) const {
  if (normals_.value.empty() || !(normals_.value[n].lengthSqr() > 0)) return std::nullopt;
  return is_reversed() ? Vec3d(0.0) - normals_.value[n] : normals_.value[n];
}

void Skin::append_coordinate(std::string& text, std::size_t v, int k, std::string_view word) const {
  if (const auto position = new_position(v)) append_number(text, (*position)[k], precision_);
  else text += word;
}

void Skin::append_normal_component(std::string& text, std::size_t n, int k, std::string_view word) const {
  if (const auto normal = new_normal(n)) append_number(text, (*normal)[k], kNormalPrecision);
  else text += is_reversed() ? negated(word) : std::string(word);
}

void Skin::append_position(std::string& text, std::size_t v) const {
  for (int k = 0; k < 3; ++k) {
    text += ' ';
    append_coordinate(text, v, k, word_at(source_.position_at[v].at[k]));
  }
}

void Skin::append_normal(std::string& text, std::size_t n) const {
  for (int k = 0; k < 3; ++k) {
    text += ' ';
    append_normal_component(text, n, k, word_at(source_.normal_at[n].at[k]));
  }
}

std::string_view Skin::word_at(std::uint64_t byte) const {
  const char comment = source_.format == Format::Obj || source_.format == Format::Off ? '#' : '\0';
  return Scanner(source_.path, source_.text(), byte, source_.format == Format::Obj, comment).token();
}

WriteResult write_shell(const std::string& path, const MeshFile& source, const Shell& shell,
                        const WriteOptions& options) {
  const Format format = require_format(path, options.format);
  const Precision precision = precision_of(path, source, options);
  require_same_mesh(source, shell);
  WriteResult result;
  Pieces pieces;
  if (format == source.format) {
    const auto content = std::make_shared<ShellContent>(ShellContent{source, shell, precision, options.normals});
    std::vector<std::string> lost;
    pieces = in_own_format(content, lost);
    result.disagreeing_normals = content->outer.new_normals().disagreeing + content->inner.new_normals().disagreeing;
    result.lost = fmt::format("{}", fmt::join(lost, ", "));
  } else {
    pieces = convert(source, format, shell, precision, options.normals, result);
  }
  write_pieces(path, pieces, [&] {
    source.bytes.require_unchanged(source.path);
    if (options.before_rename) options.before_rename();
  });
  return result;
}

WriteResult write_shell(const std::string& path, const Shell& shell, const WriteOptions& options) {
  const Format format = require_format(path, options.format);
  const Precision precision = options.digits > 0 ? Precision{Precision::Kind::Digits, options.digits} : Precision{};
  WriteResult result;
  write_pieces(path, convert(format, shell, precision, result), options.before_rename);
  return result;
}

}  // namespace vdb_offset::io
