// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "bytes/append_number.h"
#include "bytes/chunked_output.h"
#include "bytes/scanner.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"
#include "volume/volume_writers.h"

namespace vdb_offset::io {
namespace {

void write_plot3d(const std::string& path, const StructuredBlock& block) {
  const auto all_of = [&block](int k) {
    return Section{block.points.size(), [&block, k](std::string& text, std::size_t p) {
                     append_number(text, block.points[p][k]);
                     text += '\n';
                   }};
  };
  write_pieces(path,
               in_sections(fmt::format("{} {} {}\n", block.ni, block.nj, block.nk), {all_of(0), all_of(1), all_of(2)}));
}

void require_consistent(const std::string& path, const StructuredBlock& block) {
  const std::size_t count = std::size_t{block.ni} * block.nj * block.nk;
  if (block.points.size() != count)
    throw InvalidInput(fmt::format("{}: expected {} x {} x {} points, got {}", path, block.ni, block.nj, block.nk,
                                   block.points.size()));
  for (const VolumeField& field : block.point_fields)
    if (!field.values.empty() && field.values.size() != count)
      throw InvalidInput(fmt::format("{}: field {}: expected {} values, one for each of the points, got {}", path,
                                     field.name, count, field.values.size()));
}

}  // namespace

std::optional<StructuredFormat> structured_format_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  if (is_word(path.substr(dot + 1), "vts")) return StructuredFormat::Vts;
  if (is_word(path.substr(dot + 1), "xyz")) return StructuredFormat::Plot3d;
  return std::nullopt;
}

void write_structured(const std::string& path, const StructuredBlock& block) {
  const auto format = structured_format_of(path);
  if (!format) throw InvalidInput(path + ": expected a name that ends in .vts or .xyz");
  require_consistent(path, block);
  if (*format == StructuredFormat::Vts)
    replace_file(path, [&](const std::string& temporary) { write_vts({temporary, path}, block); });
  else write_plot3d(path, block);
}

}  // namespace vdb_offset::io
