#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/error.h"
#include "vdb_offset/io/iso_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/selection.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/scene.h"

namespace CLI {
class App;
class Success;
}  // namespace CLI

namespace vdb_offset::tool {

/// One distance that is asked for, and how.
struct DistanceRequest {
  std::string text;
  scene::Distance distance;
  std::string from;  ///< Then each vertex's own: a file of numbers, or ply:NAME, a property of the input.
};

/// Layers of cells that are asked for: their count and growth with the first height or the thickness of all, or a file
/// of heights.
struct LayersRequest {
  std::size_t count = 0;
  double growth = 1.2;                          ///< Each layer's height by that of the one below.
  std::optional<DistanceRequest> first, total;  ///< One of them, unless there is a file.
  std::string heights;                          ///< Of all layers, from the wall on.
  std::vector<std::string> files_of_heights;    ///< Those that this file names, once it is read.
  bool structured = false;                      ///< The mesh is a grid of quads, and so are the layers.
};

/// The offset surface as a mesh of its own, asked for with --mode iso.
struct IsoRequest {
  std::optional<double> adaptivity;
  bool use_winding = true, keep_specks = false;
  io::TransportRequest transport;
  std::string transport_text;  ///< As given; empty: all that there is.
};

/// Distances in the plane of x and y and along z, of one sign.
struct AxisDistances {
  scene::Distance xy, z;
};

/// What the command line asks for.
struct Arguments {
  std::string input, output;
  std::vector<DistanceRequest> distances;      ///< Empty for a scene that brings its own.
  const char* distance_option = "--distance";  ///< What they were given with.
  std::optional<DistanceRequest> inner;        ///< Of the inner skin of a shell, above 0.
  bool shell = false;
  std::optional<LayersRequest> layers;
  std::optional<IsoRequest> iso;
  std::vector<io::Selector> only;
  std::vector<std::string> only_texts, obstacles;
  scene::Distance clearance;
  std::string fit;                     ///< Another mesh that INPUT is to keep the clearance from; empty: none.
  std::optional<AxisDistances> axes;   ///< Then the only distance is that in the plane.
  OffsetOptions options;               ///< All but what depends on the mesh, and progress.
  std::optional<Border> border;        ///< As given; a scene's own counts otherwise.
  std::optional<Solver> solver;        ///< The same.
  std::optional<Collision> collision;  ///< The same.
  std::string weld_text, orient_text;  ///< As given.
  std::vector<std::string> symmetry_texts;
  std::string report, states, paths, vdb;
  bool curves = false;               ///< What INPUT holds, in place of a mesh.
  bool close = false;                ///< Of those, join ends that are near each other.
  std::optional<io::Format> format;  ///< Of files whose ending names none.
  io::WriteOptions write;            ///< All but its format, which is the output's alone.
  OutputFiles::Sync sync = OutputFiles::Sync::Yes;
  bool strict = false, dry_run = false, quiet = false, verbose = false;
};

constexpr int kMostThreads = 4096;  // --threads

/// The format of a mesh by its name, or else the one that was given.
std::optional<io::Format> format_of(const std::string& path, const Arguments& args);

/// A command line that cannot be carried out.
struct UsageError : Error {
  using Error::Error;
};

/// Whether a file holds curves; one that cannot be opened is for the reader to tell of.
bool holds_curves(const std::string& path);
/// Of --distance-xy and --distance-z; both or none are given. \throw UsageError
std::optional<AxisDistances> parse_axes(const std::string& xy, const std::string& z);
/// The metric in which these are one distance, and that distance, world units.
std::pair<Metric, double> settle_axes(const AxisDistances& axes, PolygonView mesh);

/// A distance, an expression, @FILE or ply:NAME. \throw InvalidOption
DistanceRequest parse_request(const std::string& text);

/// What --distance, any number of times, or --distance-from was given. \throw UsageError
std::vector<DistanceRequest> parse_distances(const std::vector<std::string>& texts, const std::string& from,
                                             const Arguments& args);

/// A whole number, in decimal digits. \throw UsageError
int parse_count(const char* option, const std::string& text, int least, int most);

/// group=NAME, material=NAME or faces=FILE, each. \throw UsageError
std::vector<io::Selector> parse_only(const std::vector<std::string>& texts);

/// 'slide', 'fixed' or 'free'. \throw UsageError
Border parse_border(const std::string& text);

/// World units or percent, 0 or more; 0 if empty. \throw UsageError
scene::Distance parse_clearance(const std::string& text);

/// 'auto', 'exact', 'none' or a tolerance. \throw UsageError
WeldOptions parse_weld(const std::string& text);

/// 'keep' or 'fix-direction-only'. \throw UsageError
Orient parse_orient(const std::string& text);

/// 'x=0', or another axis and number, or 'A,B,C,D' for A x + B y + C z = D. \throw UsageError
SymmetryPlane parse_plane(const std::string& text);

/// The arguments behind a program's or a subcommand's name, the last one first, as CLI11 takes them. What stands behind
/// `--` is a file's name, whatever it starts with.
std::vector<std::string> reversed_arguments(int argc, const char* const* argv);

/// \throw UsageError if an option or a file's name was given, but is empty, as where a script has nothing to say.
void require_values(const CLI::App& app);

/// Prints the help or the version.
void print_as_asked(const CLI::App& app, const CLI::Success& asked);

/// Parses the command line. Empty if it asked only for help or the version, which are then printed.
/// \throw UsageError with one line that says what is wrong.
std::optional<Arguments> parse_arguments(int argc, const char* const* argv);

}  // namespace vdb_offset::tool
