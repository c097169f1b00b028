// SPDX-License-Identifier: Apache-2.0
// The file of options of a case for SU2, by the names in its own template, version 8.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <string>
#include <vector>

#include "flow/case_texts.h"

namespace vdb_offset::io {
namespace {

using Kind = BoundaryPatch::Kind;

class Su2Case {
 public:
  Su2Case(const std::string& mesh, std::span<const CasePatch> patches, const Flow& flow)
      : mesh_(mesh), patches_(patches), flow_(flow), velocity_(direction_of(flow) * flow.speed) {}

  std::string options() const {
    return "% " + flow_in_words(flow_) +
           "% SU2_CFD flow.cfg\n\nSOLVER= INC_NAVIER_STOKES\nKIND_TURB_MODEL= NONE\nMATH_PROBLEM= DIRECT\n"
           "RESTART_SOL= NO\n" +
           fluid() + markers() + method() + fmt::format("\nMESH_FILENAME= {}\nMESH_FORMAT= SU2\n", mesh_) +
           "OUTPUT_FILES= ( RESTART, PARAVIEW )\nHISTORY_OUTPUT= ( ITER, RMS_RES, AERO_COEFF )\n"
           "SCREEN_OUTPUT= ( INNER_ITER, RMS_PRESSURE, RMS_VELOCITY-X, LIFT, DRAG )\n";
  }

  std::string readme() const {
    return flow_in_words(flow_) + "\n    SU2_CFD flow.cfg\n\n" +
           fmt::format("history.csv has drag and lift, by {}. In flow.cfg, conditions are:\n\n",
                       flow_.thickness > 0 ? fmt::format("length {:.6g}", flow_.length)
                                           : fmt::format("the square of the length {:.6g}", flow_.length)) +
           conditions_in_words(patches_);
  }

 private:
  std::string fluid() const {
    const double area = flow_.thickness > 0 ? flow_.length : flow_.length * flow_.length;
    return fmt::format(
        "\nINC_DENSITY_MODEL= CONSTANT\nINC_ENERGY_EQUATION= NO\nINC_NONDIM= DIMENSIONAL\nINC_DENSITY_INIT= 1.0\n"
        "INC_VELOCITY_INIT= ( {:.10g}, {:.10g}, {:.10g} )\nFLUID_MODEL= CONSTANT_DENSITY\n"
        "VISCOSITY_MODEL= CONSTANT_VISCOSITY\nMU_CONSTANT= {:.10g}\nREF_LENGTH= {:.10g}\nREF_AREA= {:.10g}\n",
        velocity_[0], velocity_[1], velocity_[2], flow_.viscosity, flow_.length, area);
  }

  /// The names of the patches of a kind, each with the same text behind it; empty if there is none.
  std::string markers_of(const char* option, Kind kind, const std::string& behind) const {
    std::vector<std::string> each;
    for (const CasePatch& patch : patches_)
      if (patch.kind == kind) each.push_back(patch.name + behind);
    return each.empty() ? "" : fmt::format("{}= ( {} )\n", option, fmt::join(each, ", "));
  }

  std::string types_of(const char* option, Kind kind, const char* type) const {
    std::string text;
    for (const CasePatch& patch : patches_)
      if (patch.kind == kind) text += std::string(text.empty() ? "" : ", ") + type;
    return text.empty() ? "" : fmt::format("{}= ( {} )\n", option, text);
  }

  std::string markers() const {
    // The temperature of an inlet, which counts only with the equation for energy, and its direction, which is across.
    const std::string inlets =
        markers_of("MARKER_INLET", Kind::Inlet, fmt::format(", 288.15, {:.10g}, 1.0, 0.0, 0.0", flow_.speed));
    return "\n" + markers_of("MARKER_HEATFLUX", Kind::Wall, ", 0.0") + markers_of("MARKER_FAR", Kind::Outer, "") +
           markers_of("MARKER_SYM", Kind::Symmetry, "") + types_of("INC_INLET_TYPE", Kind::Inlet, "VELOCITY_INLET") +
           inlets + (inlets.empty() ? "" : "INLET_USE_NORMAL= YES\n") +
           types_of("INC_OUTLET_TYPE", Kind::Outlet, "PRESSURE_OUTLET") +
           markers_of("MARKER_OUTLET", Kind::Outlet, ", 0.0") + markers_of("MARKER_PLOTTING", Kind::Wall, "") +
           markers_of("MARKER_MONITORING", Kind::Wall, "");
  }

  static std::string method() {
    return "\nNUM_METHOD_GRAD= WEIGHTED_LEAST_SQUARES\nCONV_NUM_METHOD_FLOW= FDS\nMUSCL_FLOW= YES\n"
           "SLOPE_LIMITER_FLOW= NONE\nTIME_DISCRE_FLOW= EULER_IMPLICIT\nCFL_NUMBER= 15.0\nCFL_ADAPT= NO\n"
           "LINEAR_SOLVER= FGMRES\nLINEAR_SOLVER_PREC= ILU\nLINEAR_SOLVER_ERROR= 1E-4\nLINEAR_SOLVER_ITER= 20\n"
           "ITER= 5000\nCONV_FIELD= RMS_PRESSURE\nCONV_RESIDUAL_MINVAL= -12\nCONV_STARTITER= 10\n";
  }

  const std::string& mesh_;
  std::span<const CasePatch> patches_;
  const Flow& flow_;
  Vec3d velocity_;
};

}  // namespace

CaseFiles write_su2_case(const std::string& mesh, std::span<const CasePatch> patches, const Flow& flow) {
  require_flow(patches, flow);
  const std::filesystem::path path = mesh;
  const std::string name = path.filename().string();
  const Su2Case texts(name, patches, flow);
  const CaseText files[] = {{"flow.cfg", texts.options()}, {"README", texts.readme()}};
  return write_where_missing(path.parent_path().string(), files);
}

}  // namespace vdb_offset::io
