// SPDX-License-Identifier: Apache-2.0
// Level sets and fog volumes of OpenVDB, of which a surface becomes the mesh.
#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ios>
#include <istream>
#include <limits>
#include <map>
#include <new>
#include <optional>
#include <streambuf>
#include <string>
#include <vector>

#include "document/document.h"
#include "document/format_readers.h"
#include "document/require_format.h"
#include "document/trial.h"
#include "ground/system/memory.h"
#include "ground/system/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

using openvdb::FloatGrid;
using openvdb::GridBase;

/// Such files are not written as meshes.
class VdbDocument : public Document {
 public:
  WrittenDocument rewrite(const MovedMesh& moved) const override {
    throw InvalidInput(moved.path + ": expected a format that can be written, got one that is read only");
  }
  void read_attributes(const MeshFile&, Attributes&) const override {}
  FaceNames face_names() const override { return {}; }
};

/// Reads from bytes in memory.
class ByteStream : std::streambuf {
 public:
  explicit ByteStream(std::string_view bytes) {
    char* const begin = const_cast<char*>(bytes.data());  // they are not written to
    setg(begin, begin, begin + bytes.size());
    // OpenVDB goes on with whatever stood in memory where a file ends.
    stream_.exceptions(std::ios::failbit | std::ios::badbit);
  }
  std::istream& stream() { return stream_; }

 private:
  pos_type seekoff(off_type off, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type at = from == std::ios_base::beg   ? 0
                        : from == std::ios_base::cur ? gptr() - eback()
                                                     : egptr() - eback();
    return seekpos(at + off, std::ios_base::in);
  }
  pos_type seekpos(pos_type at, std::ios_base::openmode) override {
    if (at < 0 || at > egptr() - eback()) return off_type(-1);
    setg(eback(), eback() + off_type(at), egptr());
    return at;
  }
  std::istream stream_{this};
};

openvdb::GridPtrVec read_grids(const MeshFile& file) {
  openvdb::initialize();  // further calls do nothing
  ByteStream bytes(file.text());
  const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(bytes.stream(), false).getGrids();
  return grids ? *grids : openvdb::GridPtrVec();
}

/// Appends an index to each name that is not the only one of its kind, as OpenVDB's tools show them.
void number_names(openvdb::GridPtrVec& grids) {
  std::map<std::string, std::vector<GridBase*>> of_name;
  for (const GridBase::Ptr& grid : grids) of_name[grid->getName()].push_back(grid.get());
  for (const auto& [name, some] : of_name)
    for (std::size_t i = 0; some.size() > 1 && i < some.size(); ++i) some[i]->setName(fmt::format("{}[{}]", name, i));
}

std::string in_words(const GridBase& grid) {
  const std::string name = grid.getName().empty() ? "without a name" : "'" + grid.getName() + "'";
  switch (grid.getGridClass()) {
    case openvdb::GRID_LEVEL_SET:
      return "level set " + name;
    case openvdb::GRID_FOG_VOLUME:
      return "fog volume " + name;
    default:
      return "grid " + name + " of " + grid.valueType() + "s";
  }
}

std::string all_in_words(const openvdb::GridPtrVec& grids) {
  constexpr std::size_t kMost = 8;
  std::string words;
  for (std::size_t i = 0; i < std::min(grids.size(), kMost); ++i) words += (i > 0 ? ", " : "") + in_words(*grids[i]);
  return grids.size() > kMost ? words + " ..." : words.empty() ? "none" : words;
}

/// The grid of floats that is asked for, or else the only level set, or the only one.
/// Not of doubles: what a program compiles of DoubleTree and what the library has of it do not go together in
/// Debian 12.
const FloatGrid& choose(const MeshFile& file, const openvdb::GridPtrVec& grids, const VdbReading& how) {
  std::vector<const FloatGrid*> level_sets, scalars;
  for (const GridBase::Ptr& grid : grids) {
    if (!how.grid.empty() && grid->getName() != how.grid) continue;
    const auto* const floats = dynamic_cast<const FloatGrid*>(grid.get());
    if (!floats) continue;
    scalars.push_back(floats);
    if (floats->getGridClass() == openvdb::GRID_LEVEL_SET) level_sets.push_back(floats);
  }
  const std::vector<const FloatGrid*>& some = level_sets.empty() ? scalars : level_sets;
  if (some.size() == 1) return *some.front();
  const std::string wanted = how.grid.empty() ? "a level set" : "a level set or fog volume '" + how.grid + "'";
  throw InvalidInput(fmt::format("{}: expected {}, got {}{}", file.path, wanted, all_in_words(grids),
                                 some.size() > 1 ? " (--grid NAME picks one)" : ""));
}

/// Takes the surface of a grid of floats.
class GridMesher {
 public:
  GridMesher(const FloatGrid& grid, MeshFile& file, double isovalue)
      : grid_(grid), file_(file), isovalue_(isovalue), is_fog_(grid.getGridClass() != openvdb::GRID_LEVEL_SET) {}

  void mesh() {
    look_at_values();
    // In index space: floats of world coordinates would be coarser far from the origin.
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    const openvdb::FloatGrid::Ptr in_voxels =
        FloatGrid::create(std::const_pointer_cast<openvdb::FloatTree>(grid_.constTreePtr()));
    openvdb::tools::volumeToMesh(*in_voxels, points, triangles, quads, isovalue_, 0.0);
    if (triangles.empty() && quads.empty())
      throw InvalidInput(fmt::format("{}: expected a surface where the {} is {:g}, got values from {:g} to {:g}",
                                     file_.path, in_words(grid_), isovalue_, least_, most_));
    if (points.size() > kMostVertices)
      throw InvalidInput(
          fmt::format("{}: expected at most {} vertices, got {}", file_.path, kMostVertices, points.size()));
    Polygons& polygons = file_.polygons;
    polygons.positions.resize(points.size());
    for_each_index(points.size(), [&](std::size_t i) {
      polygons.positions[i] = grid_.transform().indexToWorld(on_surface(openvdb::Vec3d(points[i])));
    });
    for (const Vec3d& position : polygons.positions)
      if (!position.isFinite())
        throw InvalidInput(file_.path + ": expected a transform to finite coordinates, got another one");
    // volumeToMesh turns faces away from what is below the isovalue: the inside of a level set, and the outside of all
    // other grids. A mirroring transform turns them once more.
    const bool turns = is_fog_ != is_mirrored();
    for (const auto& each : quads) add(std::array{each[0], each[1], each[2], each[3]}, turns);
    for (const auto& each : triangles) add(std::array{each[0], each[1], each[2]}, turns);
  }

 private:
  /// \throw InvalidInput for numbers that are not finite, OutOfBudget for a surface that may be too large for memory
  void look_at_values() {
    constexpr double kBytesForEach = 64;  // voxel that the surface may pass through; not measured
    bool all = std::isfinite(grid_.background());
    double crossed = 0;  // at most: all voxels of leaf nodes, and those on the sides of tiles
    for (auto value = grid_.cbeginValueOn(); value; ++value) {
      all = all && std::isfinite(*value);
      least_ = std::min(least_, *value), most_ = std::max(most_, *value);
      crossed += value.isVoxelValue() ? 1 : 6 * std::pow(static_cast<double>(value.getVoxelCount()), 2.0 / 3);
    }
    if (!all)
      throw InvalidInput(fmt::format("{}: expected finite numbers in the {}, got others", file_.path, in_words(grid_)));
    constexpr double kNoMemory = 1e18;  // bytes
    require_memory(static_cast<std::size_t>(std::min(kBytesForEach * crossed, kNoMemory)), file_.path);
  }

  /// Goes from a point that is about on the surface to where the values, interpolated, are the isovalue: a few steps of
  /// Newton's method along their gradient, within the cell of eight voxels that the point is in, so that none passes
  /// another one. volumeToMesh's vertices are means of crossings.
  openvdb::Vec3d on_surface(const openvdb::Vec3d& from) const {
    constexpr int kSteps = 4;
    constexpr double kProbe = 0.25;  // voxels
    const auto value = [accessor = grid_.getConstAccessor()](const openvdb::Vec3d& x) {
      return static_cast<double>(openvdb::tools::BoxSampler::sample(accessor, x));
    };
    openvdb::Vec3d x = from;
    double off = value(x) - isovalue_;
    for (int i = 0; i < kSteps; ++i) {
      openvdb::Vec3d gradient;
      for (int k = 0; k < 3; ++k) {
        openvdb::Vec3d step(0.0);
        step[k] = kProbe;
        gradient[k] = (value(x + step) - value(x - step)) / (2 * kProbe);
      }
      const double squared = gradient.lengthSqr();
      if (!(squared > 0)) break;
      const openvdb::Vec3d next = x - gradient * (off / squared);
      const double off_there = value(next) - isovalue_;
      if (openvdb::Coord::floor(next) != openvdb::Coord::floor(from) || !(std::abs(off_there) < std::abs(off))) break;
      x = next;
      off = off_there;
    }
    return x;
  }

  bool is_mirrored() const {
    const auto& transform = grid_.transform();
    const openvdb::Vec3d at = grid_.evalActiveVoxelBoundingBox().getCenter(), origin = transform.indexToWorld(at);
    std::array<openvdb::Vec3d, 3> axis;
    for (std::size_t k = 0; k < 3; ++k) {
      openvdb::Vec3d next = at;
      next[static_cast<int>(k)] += 1;
      axis[k] = transform.indexToWorld(next) - origin;
    }
    return axis[0].cross(axis[1]).dot(axis[2]) < 0;
  }

  template <std::size_t kCorners>
  void add(std::array<std::uint32_t, kCorners> corners, bool turns) {
    if (turns) std::reverse(corners.begin(), corners.end());
    file_.polygons.corners.insert(file_.polygons.corners.end(), corners.begin(), corners.end());
    file_.polygons.close_face();
  }

  const FloatGrid& grid_;
  MeshFile& file_;
  double isovalue_;
  bool is_fog_;
  float least_ = std::numeric_limits<float>::infinity(), most_ = -std::numeric_limits<float>::infinity();
};

void mesh(MeshFile& file, const VdbReading& how) {
  openvdb::GridPtrVec grids = read_grids(file);
  number_names(grids);
  const FloatGrid& grid = choose(file, grids, how);
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET && !how.isovalue)
    throw InvalidInput(fmt::format("{}: expected a level set, got a {} (--isovalue V takes the surface where it is V)",
                                   file.path, in_words(grid)));
  file.voxel_size = grid.voxelSize()[0];
  GridMesher(grid, file, how.isovalue.value_or(0)).mesh();
}

}  // namespace

void parse_vdb(MeshFile& file, const VdbReading& how) {
  // Most memory that reading may take: blocks of zeros are packed a thousandfold. Enough for small files.
  constexpr std::size_t kMostPerByte = 1000, kAtLeast = std::size_t{1} << 30, kMost = std::size_t{1} << 36;
  require_memory(2 * file.text().size(), file.path);
  // OpenVDB trusts what it reads, and loses memory where that ends too soon. It reads without oneTBB, whose threads a
  // child has not.
  if (!try_in_child(file.path, std::min(kMostPerByte * file.text().size() + kAtLeast, kMost),
                    [&] { read_grids(file); }))
    throw InvalidInput(file.path +
                       ": expected a file that OpenVDB reads, got one that is cut short, or none of OpenVDB's");
  try {
    mesh(file, how);
  } catch (const openvdb::Exception& error) {
    throw InvalidInput(fmt::format("{}: expected a file that OpenVDB reads, got: {}", file.path, error.what()));
  } catch (const std::bad_alloc&) {
    throw OutOfBudget(file.path + ": expected grids that fit into memory, got more");
  }
  file.encoding = Encoding::LittleEndian;
  file.document = std::make_shared<VdbDocument>();
}

}  // namespace vdb_offset::io
