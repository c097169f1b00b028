#include "vdb_offset/io/pieces.h"

#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>

#include "vdb_offset/file_replace.h"
#include "vdb_offset/io/compression.h"

namespace vdb_offset::io {
namespace {

void produce(const Pieces& pieces, Compression compression, const Sink& sink) {
  std::size_t next = 0;
  const auto number =
      tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& at) {
        if (next == pieces.count) at.stop();
        return next++;
      });
  const auto make = tbb::make_filter<std::size_t, std::string>(
      tbb::filter_mode::parallel, [&](std::size_t i) { return compress(compression, pieces.make(i)); });
  const auto write = tbb::make_filter<std::string, void>(tbb::filter_mode::serial_in_order,
                                                         [&](const std::string& piece) { sink(piece); });
  tbb::parallel_pipeline(static_cast<std::size_t>(2 * tbb::info::default_concurrency()), number & make & write);
}

}  // namespace

void write_pieces(const std::string& path, const Pieces& pieces, const std::function<void()>& before_rename) {
  write_file(
      path, [&](const Sink& sink) { produce(pieces, compression_of(path), sink); }, before_rename);
}

std::string join(const Pieces& pieces) {
  std::string bytes;
  produce(pieces, Compression::None, [&](std::string_view piece) { bytes += piece; });
  return bytes;
}

}  // namespace vdb_offset::io
