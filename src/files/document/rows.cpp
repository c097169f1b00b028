// SPDX-License-Identifier: Apache-2.0
// Writes a file again with other numbers where they stand. The source's bytes, the place of each coordinate and normal,
// and new values go in; pieces of the new file come out, which can be made in any order and on several threads. A text
// is cut at lines, a binary file between vertices and normals. In a text, the digits of a changed number are replaced
// up to the white space, comment or joining backslash behind it; in a binary file, its bytes are overwritten in their
// width and order. Every other byte of the source stays, and so do the numbers of vertices that did not move. Line ends
// that are carriage returns alone are put back. Rows are neither added nor taken away here; formats do that themselves.
#include "document/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "bytes/append_number.h"
#include "bytes/line_records.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// Bytes of a binary file that are made at a time. Not measured beside other sizes.
constexpr std::size_t kPiece = std::size_t{1} << 20;

/// A number in a text that gets another value.
struct ChangedNumber {
  std::uint64_t at;
  double value;
  bool of_normal;
};

class Rewriter {
 public:
  Rewriter(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
           std::shared_ptr<const NewNormals> normals, std::size_t begin, std::size_t end)
      : source_(source),
        rows_(rows_of(source)),
        positions_(positions),
        precision_(precision),
        normals_(std::move(normals)) {
    VDB_OFFSET_ASSERT(positions.size() == source.polygons.positions.size());
    VDB_OFFSET_ASSERT(rows_.position_at.size() == positions.size());
    cuts_ = source.encoding == Encoding::Ascii ? cut_at_lines(source.text().substr(0, end), begin)
                                               : cut_between_numbers(begin, end);
  }

  std::size_t pieces() const { return cuts_.size() - 1; }

  std::string make(std::size_t piece) const {
    const std::uint64_t begin = cuts_[piece], end = cuts_[piece + 1];
    return source_.encoding == Encoding::Ascii ? in_text(begin, end) : in_binary(begin, end);
  }

 private:
  bool moved(std::size_t v) const { return has_moved(source_.polygons.positions[v], positions_[v], precision_); }

  /// Cuts a binary file into pieces, none of them between the numbers of one vertex or one normal.
  std::vector<std::size_t> cut_between_numbers(std::size_t begin, std::size_t end) const {
    std::vector<std::size_t> cuts{begin};
    while (cuts.back() < end) {
      std::uint64_t cut = std::min(cuts.back() + kPiece, end);
      for (const auto& [offsets, bytes] :
           {std::pair{&rows_.position_at, rows_.position_bytes}, {&rows_.normal_at, rows_.normal_bytes}}) {
        const std::size_t i = offsets->first_from(cut);
        if (i > 0) cut = std::max(cut, last_of((*offsets)[i - 1]) + bytes);
        if (i < offsets->size() && first_of((*offsets)[i]) < cut) cut = last_of((*offsets)[i]) + bytes;
      }
      cuts.push_back(cut);
    }
    return cuts;
  }
  static std::uint64_t first_of(const NumberTriple& t) { return std::min({t.at[0], t.at[1], t.at[2]}); }
  static std::uint64_t last_of(const NumberTriple& t) { return std::max({t.at[0], t.at[1], t.at[2]}); }

  /// Calls visit(byte offset, value, whether it is a normal's) for every number from `begin` to `end` that changes:
  /// coordinates first, in the file's order, then normals.
  template <class Visit>
  void for_each_number(std::uint64_t begin, std::uint64_t end, Visit&& visit) const {
    const auto each = [&](const ByteOffsets& offsets, bool of_normals, auto&& value_of) {
      for (std::size_t i = offsets.first_from(begin); i < offsets.size(); ++i) {
        const NumberTriple triple = offsets[i];
        if (first_of(triple) >= end) return;
        const std::optional<Vec3d> value = value_of(i);
        const int numbers = triple.at[2] == triple.at[1] ? 2 : 3;  // points of plane curves have two numbers
        for (int k = 0; value && k < numbers; ++k)
          if (triple.at[k] >= begin && triple.at[k] < end) visit(triple.at[k], (*value)[k], of_normals);
      }
    };
    each(rows_.position_at, false, [&](std::size_t v) -> std::optional<Vec3d> {
      if (moved(v)) return precision_(positions_[v]);
      return std::nullopt;
    });
    if (!normals_->value.empty())
      each(rows_.normal_at, true, [&](std::size_t n) -> std::optional<Vec3d> {
        if (normals_->value[n].lengthSqr() > 0) return normals_->value[n];
        return std::nullopt;
      });
  }

  std::string in_text(std::uint64_t begin, std::uint64_t end) const {
    const std::vector<ChangedNumber> changes = in_order(begin, end);
    const std::string_view bytes = source_.text();
    std::string text;
    text.reserve((end - begin) + changes.size() * 12);
    const Rounding of_normals{Rounding::Kind::Single};  // single precision is enough for a normal
    std::uint64_t copied = begin;
    for (const ChangedNumber& change : changes) {
      text.append(bytes, copied, change.at - copied);
      append_number(text, change.value, change.of_normal ? of_normals : precision_);
      for (copied = change.at; copied < end && !ends_number(copied);) ++copied;
    }
    return text.append(bytes, copied, end - copied);
  }
  std::vector<ChangedNumber> in_order(std::uint64_t begin, std::uint64_t end) const {
    std::vector<ChangedNumber> changes;
    for_each_number(begin, end, [&](std::uint64_t at, double value, bool of_normal) {
      changes.push_back({at, value, of_normal});
    });
    const auto by_place = [](const ChangedNumber& a, const ChangedNumber& b) { return a.at < b.at; };
    if (!std::is_sorted(changes.begin(), changes.end(), by_place)) std::sort(changes.begin(), changes.end(), by_place);
    return changes;
  }
  /// Whether a number ends at this byte: at white space, at a comment if the format has comments, or at a backslash
  /// that joins lines.
  bool ends_number(std::uint64_t at) const {
    const char c = source_.text()[at];
    if (is_blank(c) || c == '\n') return true;
    if (c == rows_.syntax().comment && c != '\0') return true;
    if (c != '\\' || !rows_.syntax().joins_lines) return false;
    const std::string_view rest = source_.text().substr(at);
    return rest.starts_with("\\\n") || rest.starts_with("\\\r\n");
  }

  std::string in_binary(std::uint64_t begin, std::uint64_t end) const {
    std::string bytes(source_.text().substr(begin, end - begin));
    for_each_number(begin, end, [&](std::uint64_t at, double value, bool of_normal) {
      char raw[8];
      const std::uint8_t size = of_normal ? rows_.normal_bytes : rows_.position_bytes;
      const auto narrow = static_cast<float>(value);
      if (size == 4) std::memcpy(raw, &narrow, 4);
      else std::memcpy(raw, &value, 8);
      if (source_.encoding == Encoding::BigEndian) std::reverse(raw, raw + size);
      std::memcpy(bytes.data() + (at - begin), raw, size);
    });
    return bytes;
  }

  const MeshFile& source_;
  const Rows& rows_;
  std::span<const Vec3d> positions_;
  Rounding precision_;
  std::shared_ptr<const NewNormals> normals_;
  std::vector<std::size_t> cuts_;
};

}  // namespace

const Rows& rows_of(const MeshFile& file) {
  VDB_OFFSET_ASSERT(has_rows(file));
  return *file.document->rows();
}

WrittenDocument Rows::rewrite(const MovedMesh& moved) const {
  return {rewrite_in_place(moved.source, moved.positions, moved.precision, moved.normals), {}, {}};
}

std::vector<double> Rows::vertex_numbers(const MeshFile& source, const std::string& name) const {
  throw InvalidInput(fmt::format("{}: expected a PLY file, whose vertices can have a property '{}', found {}",
                                 source.path, name, io::name(source.format)));
}

std::string Rows::with_face_rows(const MeshFile& source, std::vector<std::string>&) const {
  return std::string(source.text());
}

bool use_line_feeds(MeshFile& file) {
  const std::string_view text = file.text();
  if (text.find('\n') != std::string_view::npos || text.find('\r') == std::string_view::npos) return false;
  std::string lines(text);
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  file.bytes.show(std::move(lines));
  return true;
}

Pieces with_line_ends_of(const MeshFile& source, Pieces pieces) {
  if (!rows_of(source).has_carriage_returns) return pieces;
  return {pieces.count, [make = std::move(pieces.make)](std::size_t piece) {
            std::string text = make(piece);
            std::replace(text.begin(), text.end(), '\n', '\r');
            return text;
          }};
}

Pieces rewrite_rows(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                    std::shared_ptr<const NewNormals> normals, std::size_t begin, std::size_t end) {
  const auto rewriter = std::make_shared<const Rewriter>(source, positions, precision, std::move(normals), begin, end);
  return {rewriter->pieces(), [rewriter](std::size_t piece) { return rewriter->make(piece); }};
}

Pieces rewrite_in_place(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                        std::shared_ptr<const NewNormals> normals) {
  return with_line_ends_of(source,
                           rewrite_rows(source, positions, precision, std::move(normals), 0, source.text().size()));
}

}  // namespace vdb_offset::io
