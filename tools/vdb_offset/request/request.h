// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "request/units.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/fill.h"
#include "vdb_offset/io/case_file.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/options.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {

/// A command line that cannot be carried out.
struct UsageError : Error {
  using Error::Error;
};

/// The options that were given, by their long names, and again with each value, as in "--mode iso".
using GivenNames = std::set<std::string>;

/// An option that a preset gave, by its long name.
struct PresetOption {
  std::string name;
  bool is_flag;
  std::string preset;
};

/// One distance that is asked for, and how.
struct DistanceRequest {
  std::string text;
  GivenDistance distance;
  std::string from;  ///< Then each vertex's own: a file of numbers, or ply:NAME or vtk:NAME, a property of the input.
};

/// The distance of a part of the mesh, in place of what the others have.
struct PartDistance {
  io::Selector part;
  DistanceRequest distance;
};

/// Distances in the plane of x and y and along z, of one sign.
struct AxisDistances {
  GivenDistance xy, z;
};

/// A length of layers that is asked for, and the option that it was given with.
struct LayerLength {
  const char* option;
  const DistanceRequest* asked;
};

/// Layers of cells that are asked for: what is known of a LayerPlan, or a file of heights.
struct LayersRequest {
  std::size_t count = 0;         ///< 0: as follows from the others, or as many as the file of heights has.
  std::optional<double> growth;  ///< Each layer's height by that of the one below; none: it follows from the others.
  std::optional<DistanceRequest> first, total, last;  ///< One or two of them, unless there is a file.
  std::optional<double> y_plus;                       ///< In place of the first height; below 0 inward.
  std::string heights;                                ///< A file with those of all layers, from the wall on.
  std::optional<double> fan_angle;                    ///< Degrees; 0: no fans.
  bool structured = false;                            ///< The mesh is a grid of quads, and so are the layers.

  /// Those lengths that are given as such, in the order in which they are declared.
  std::vector<LayerLength> lengths() const;
};

/// Tetrahedra in the rest of the domain that layers begin.
struct FillRequest {
  Farfield farfield;          ///< Without the surface of a file.
  std::string farfield_text;  ///< As given; empty: it was not.
  std::string farfield_file;  ///< The file of its surface; empty: none.
  double growth = 1.3;
  std::optional<GivenDistance> longest;
  std::optional<FillQuads> quads;  ///< None: as OUTPUT can hold.
  FillWith with = FillWith::Netgen;
  bool caps = true;  ///< Cover flat openings.
  double seconds = 3600;
  bool layers_anyway = false;  ///< Where the rest cannot be filled, write the layers alone.
};

/// What a patch of a mesh of cells is to be called, and what it is.
struct PatchRequest {
  std::string patch, name;
  std::optional<BoundaryPatch::Kind> kind;
};

/// The flow that layers or a case are for.
struct FlowRequest {
  io::Flow given;  ///< Its speed and direction.
  /// The viscosity is kinematic, with a density dynamic; or else it follows from the Reynolds number.
  std::optional<double> viscosity, density, reynolds, length;
};

/// A case for a solver beside the mesh of cells.
struct CaseRequest {
  std::string folder;   ///< Empty: none is asked for.
  bool of_su2 = false;  ///< Else of OpenFOAM.
};

/// The iso-surface at the distance, asked for with --mode iso.
struct IsoRequest {
  std::optional<double> adaptivity;
  bool use_winding = true, keep_specks = false;
  io::TransportRequest transport;
  std::string transport_text;  ///< The words as given; empty: all that there is.
};

/// A distance that is asked for at every point of the faces, which are split for it.
struct ToleranceRequest {
  Tolerance tolerance;              ///< All but the precision.
  std::string text;                 ///< The tolerance as given.
  std::string refined_source, map;  ///< Files to write; empty: not asked for.
};

/// What a command line asks for: options that go together, each with a value that it can have. It depends on the words
/// of the command line alone, as no file has been opened for it; resolve() makes a Job of it.
struct Request {
  GivenNames given;
  std::vector<PresetOption> of_preset;  ///< Those of them that a preset gave.
  std::string input, output;
  std::string config;                          ///< The file that options were taken from, too; empty: none.
  std::vector<DistanceRequest> distances;      ///< Empty for a scene that brings its own, and for layers.
  std::optional<Vec3d> side_of;                ///< Distances go to the side of this point; they have no signs then.
  const char* distance_option = "--distance";  ///< The option that they were given with.
  std::vector<PartDistance> distances_of;      ///< Of parts; where several name a face, the last counts.
  GivenDistance blend;                         ///< Over how far distances of parts change into each other; 0: not.
  std::optional<AxisDistances> axes;           ///< Then the only distance is that in the plane.
  std::optional<DistanceRequest> inner;        ///< The distance of a shell's inner skin, above 0.
  std::string fit;                             ///< Another mesh that INPUT is to keep the clearance from; empty: none.
  bool shell = false;
  std::optional<LayersRequest> layers;
  std::optional<FillRequest> fill;
  std::vector<PatchRequest> patches;
  FlowRequest flow;
  CaseRequest solver_case;
  std::optional<IsoRequest> iso;
  std::optional<ToleranceRequest> tolerance;

  std::vector<io::Selector> only;
  std::vector<std::string> obstacles;
  GivenDistance clearance;
  SymmetryOptions symmetry;
  std::optional<PeriodicMotion> periodic;
  std::string periodic_text;

  // Without a value, a scene's own counts.
  std::optional<Border> border;
  std::optional<Solver> solver;
  std::optional<Collision> collision;
  std::optional<Corners> corners;
  std::optional<double> miter_limit, taper;

  GridOptions grid;
  WeldOptions weld = WeldOptions::automatic();
  Orient orient = Orient::Keep;
  int threads = 0;                          ///< 0: all.
  std::size_t max_memory = 0;               ///< Bytes.
  bool close = false;                       ///< Join ends of curves that are near each other.
  io::VdbReading level_set;                 ///< Which surface of an OpenVDB file is the mesh.
  std::optional<GivenDistance> deflection;  ///< Of CAD models; none: by the distance.
  double fit_tolerance = 0;                 ///< Of written CAD models, world units; 0: 1e-4 distances.
  bool exact = false;                       ///< Write a CAD model of exact faces, or none.
  bool cuts = false;                        ///< --collision cut: of an output that is a CAD model.
  bool fuses_bodies = false;                ///< Of CAD models: solids that touch are read as one.
  double angle = 15, cad_seconds = 300;     ///< Of CAD models: degrees, and how long reading may take.
  std::optional<GivenDistance> flatten;     ///< How far straight segments may be from curved ones; none: the default.

  std::string unit;  ///< Of the file's numbers; empty: not said.
  Lengths lengths;   ///< What is printed of lengths.
  // Texts as given, for the report.
  std::vector<std::string> only_texts, symmetry_texts, distance_of_texts;
  std::string blend_text;
  std::string clearance_text, weld_text = "auto", orient_text = "keep";

  std::string report, states, paths, html, vdb;  ///< Files to write; empty: not asked for.
  std::string command;                           ///< As it was typed, for the page.
  std::optional<io::Format> format;              ///< Of files with an ending that names none.
  io::WriteOptions write;                        ///< All but its format, which is the output's alone.
  OutputFiles::Sync sync = OutputFiles::Sync::Yes;
  std::optional<double> strict_faces;      ///< Percent.
  std::optional<double> strict_certified;  ///< Percent.
  bool strict = false, dry_run = false, quiet = false, verbose = false;

  /// The share of the area that has to be certified to be within the tolerance; none: it is not judged.
  std::optional<double> certified_asked() const {
    if (strict_certified) return *strict_certified / 100;
    return strict ? std::optional(1.0) : std::nullopt;
  }
};

/// Reads the command line of an offset. Empty if it asked only for help or the version, which are then printed.
/// \throw UsageError with one line that says what to change.
std::optional<Request> parse_command_line(int argc, const char* const* argv);

/// \throw UsageError if what was asked for is not for what INPUT holds: curves, or a mesh
void require_for_input(const Request& request, bool curves);

/// The format of a mesh by its name, or else the one that was given.
std::optional<io::Format> format_of(const std::string& path, const Request& request);

/// Whether an output is to be a CAD model.
bool is_level_set_output(const std::string& path, const Request& request);
bool is_cad_output(const std::string& path, const Request& request);

/// How meshes are written, in the format of a file of that name.
io::WriteOptions write_options(const Request& request, const std::string& path);

}  // namespace vdb_offset::tool
