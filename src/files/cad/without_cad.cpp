// SPDX-License-Identifier: Apache-2.0
// A build without OpenCASCADE.
#include <utility>

#include "cad/cad_worker.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

struct CadWorker::State {};

CadWorker::CadWorker(std::string path, std::string_view, std::string_view, const CadMeshing&, double, std::uint64_t,
                     const ProgressCallback&) {
  throw ReadError(std::move(path) +
                  ": expected a build with OpenCASCADE, which reads such files, got one without (VDB_OFFSET_CAD)");
}

CadWorker::~CadWorker() = default;
CadWorker::CadWorker(CadWorker&&) noexcept = default;
CadWorker& CadWorker::operator=(CadWorker&&) noexcept = default;

// Never called: there is none of these.
std::vector<double> CadWorker::distance_errors(std::span<const CadPoint>) { return {}; }
std::vector<Vec3d> CadWorker::offset_points(std::span<const CadAim>, std::span<const CadPlace>) { return {}; }
CadWritten CadWorker::write(WriteCad, const ProgressCallback&) { return {}; }
std::string CadWorker::request(CadRequest, std::string_view, const ProgressCallback&) { return {}; }

}  // namespace vdb_offset::io
