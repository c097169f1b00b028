// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include <unistd.h>

#include "cad/cad_worker.h"
#include "support/places.h"

namespace vdb_offset::test {

/// The files that make_models makes, for as long as this process lives.
class CadFiles {
 public:
  CadFiles() : folder_(std::filesystem::temp_directory_path() / ("vdb_offset_cad_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    is_made_ =
        std::system((cad_models_path() + " '" + folder_.string() + "' >'" + folder_.string() + "/log' 2>&1").c_str()) ==
        0;
  }
  ~CadFiles() { std::filesystem::remove_all(folder_); }

  std::string bytes(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  const std::filesystem::path& folder() const { return folder_; }
  bool is_made() const { return is_made_; }

 private:
  std::filesystem::path folder_;
  bool is_made_ = false;
};

inline const CadFiles& cad_files() {
  static const CadFiles files;
  return files;
}

inline constexpr double kCadSeconds = 60;

inline io::CadWorker open_cad(const std::string& name, double deflection = 0.01) {
  const io::CadMeshing meshing{{deflection, 0, 15 * std::numbers::pi / 180}};
  return {name, cad_files().bytes(name), name.substr(name.rfind('.')), meshing, kCadSeconds, 0};
}

}  // namespace vdb_offset::test
