// SPDX-License-Identifier: Apache-2.0
#include "bytes/chunked_output.h"

#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bytes/compression.h"
#include "ground/system/call_progress.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::io {
namespace {

// Items of a section in one piece of a file: about a MiB. Not measured beside other numbers.
constexpr std::size_t kPerPiece = 1 << 15;

/// Makes pieces in parallel and writes them in order. Pieces that are made wait in slots of ours, not in the pipeline,
/// which would lose their memory if it is cancelled. As pieces are written in order, the slot of a piece is free again
/// once as many more pieces have been started as there are slots.
void produce(const Pieces& pieces, Compression compression, const Sink& sink) {
  const auto under_way = static_cast<std::size_t>(2 * tbb::info::default_concurrency());
  std::vector<std::string> made(under_way);
  std::size_t next = 0;
  const auto number =
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& at) {
        if (next == pieces.count) at.stop();
        return next++;
      });
  const auto make = tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, [&](std::size_t i) {
    made[i % under_way] = compress(compression, pieces.make(i));
    return i;
  });
  const auto write = tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order,
                                                         [&](std::size_t i) { sink(made[i % under_way]); });
  tbb::parallel_pipeline(under_way, number & make & write);
}

}  // namespace

Pieces in_sections(const std::string& header, std::vector<Section> sections) {
  std::erase_if(sections, [](const Section& section) { return section.items == 0; });
  const auto pieces_of = [](const Section& section) { return (section.items + kPerPiece - 1) / kPerPiece; };
  std::size_t count = 1;
  for (const Section& section : sections) count += pieces_of(section);
  return {count, [=](std::size_t piece) {
            if (piece == 0) return header;
            std::size_t of_section = piece - 1;
            auto section = sections.begin();
            for (; of_section >= pieces_of(*section); ++section) of_section -= pieces_of(*section);
            std::string bytes;
            const std::size_t first = of_section * kPerPiece;
            for (std::size_t i = first; i < std::min(first + kPerPiece, section->items); ++i) section->append(bytes, i);
            return bytes;
          }};
}

Pieces in_a_row(std::vector<Pieces> files) {
  std::size_t count = 0;
  for (const Pieces& file : files) count += file.count;
  return {count, [files = std::move(files)](std::size_t piece) {
            auto file = files.begin();
            for (; piece >= file->count; ++file) piece -= file->count;
            return file->make(piece);
          }};
}

void write_pieces(const std::string& path, const Pieces& pieces) {
  const ProgressCallback progress = OutputFiles::progress_of_next();
  write_file(path, [&](const Sink& sink) {
    std::size_t written = 0;
    produce(pieces, compression_of(path), [&](std::string_view bytes) {
      sink(bytes);
      report_share(progress, Stage::Write, static_cast<double>(++written) / static_cast<double>(pieces.count));
    });
  });
}

void write_pieces_of(const std::string& source, const FileBytes& bytes, const std::string& path, const Pieces& pieces) {
  OutputFiles files;
  write_pieces(path, pieces);
  bytes.require_unchanged(source);
  files.commit();
}

std::string join(const Pieces& pieces) {
  std::string bytes;
  produce(pieces, Compression::None, [&](std::string_view piece) { bytes += piece; });
  return bytes;
}

}  // namespace vdb_offset::io
