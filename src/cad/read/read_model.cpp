// SPDX-License-Identifier: Apache-2.0
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESModel.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_Face.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <UnitsMethods.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>

#include "ground/numbers/disjoint_sets.h"
#include "read/document.h"
#include "read/name_instances.h"

namespace vdb_offset::cad {
namespace {

constexpr double kMicrometres = 1000;  // of a millimetre

/// The units of length of a STEP file, in millimetres, and how exact it is in these.
struct StepUnits {
  std::set<double> lengths;
  double tolerance = 0;
};

StepUnits step_units(const opencascade::handle<Interface_InterfaceModel>& entities) {
  StepUnits units;
  for (int k = 1; k <= entities->NbEntities(); ++k) {
    opencascade::handle<StepRepr_GlobalUnitAssignedContext> context;
    opencascade::handle<StepRepr_GlobalUncertaintyAssignedContext> uncertainty;
    const auto entity = entities->Value(k);
    if (const auto both =
            opencascade::handle<StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx>::DownCast(entity);
        !both.IsNull()) {
      context = both->GlobalUnitAssignedContext();
      uncertainty = both->GlobalUncertaintyAssignedContext();
    } else if (const auto one =
                   opencascade::handle<StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext>::DownCast(
                       entity);
               !one.IsNull()) {
      context = one->GlobalUnitAssignedContext();
    }
    if (context.IsNull()) continue;
    STEPConstruct_UnitContext factors;
    factors.ComputeFactors(context);
    if (!factors.LengthDone() || !(factors.LengthFactor() > 0)) continue;
    units.lengths.insert(factors.LengthFactor());
    if (!uncertainty.IsNull() && factors.ComputeTolerance(uncertainty) == 0 && factors.HasUncertainty())
      units.tolerance = std::max(units.tolerance, factors.Uncertainty());
  }
  return units;
}

/// The names of solids and faces. (OpenCASCADE's own option for these, read.stepcaf.subshapes.name, takes solids of
/// broken files for whole.)
Names step_names(const XSControl_WorkSession& session) {
  Names names;
  const auto process = session.TransferReader()->TransientProcess();
  const auto& entities = session.Model();
  for (int k = 1; k <= entities->NbEntities(); ++k) {
    const auto entity = entities->Value(k);
    if (!entity->IsKind(STANDARD_TYPE(StepShape_Face)) && !entity->IsKind(STANDARD_TYPE(StepShape_SolidModel)))
      continue;
    const auto item = opencascade::handle<StepRepr_RepresentationItem>::DownCast(entity);
    if (item.IsNull() || item->Name().IsNull() || item->Name()->IsEmpty()) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
    if (!shape.IsNull()) names.try_emplace(shape.TShape().get(), item->Name()->ToCString());
  }
  return names;
}

void set_unit(CadModel& model, double millimetres, bool has_unit) {
  model.unit_micrometres = millimetres * kMicrometres;
  model.has_unit = has_unit;
}

}  // namespace

CadModel read_step(const std::string& path) {
  STEPCAFControl_Reader reader;
  // What is drawn and written around faces is not read.
  reader.SetGDTMode(false);
  reader.SetMatMode(false);
  reader.SetPropsMode(false);
  reader.SetViewMode(false);
  reader.SetSHUOMode(true);  // colours of instances in one of the places of their assembly
  UnitsMethods::SetCasCadeLengthUnit(1.0);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    throw InvalidCad("expected a STEP file, got one that OpenCASCADE cannot read");
  const StepUnits units = step_units(reader.Reader().WS()->Model());
  CadModel model;
  const double unit = units.lengths.size() == 1 ? *units.lengths.begin() : 1.0;
  if (units.lengths.size() > 1) model.remarks.emplace_back("has several units of length, and is read in millimetres");
  set_unit(model, unit, !units.lengths.empty());
  model.tolerance = units.tolerance;
  auto document = make_document(unit);
  if (!reader.Transfer(document))
    throw InvalidCad("expected a STEP file with shapes, got one of which OpenCASCADE makes none");
  name_instances(reader, document);
  add_document(document, step_names(*reader.Reader().WS()), model);
  return model;
}

CadModel read_iges(const std::string& path) {
  IGESCAFControl_Reader reader;
  UnitsMethods::SetCasCadeLengthUnit(1.0);
  const bool is_read = reader.ReadFile(path.c_str()) == IFSelect_RetDone;
  const auto entities = opencascade::handle<IGESData_IGESModel>::DownCast(reader.WS()->Model());
  if (!is_read || entities.IsNull() || entities->NbEntities() == 0)
    throw InvalidCad("expected an IGES file, got one that OpenCASCADE cannot read");
  CadModel model;
  double unit = 1;
  const IGESData_GlobalSection& about = entities->GlobalSection();
  constexpr int kNamedUnit = 3;  // a unit by a name of its own, of which the length is not known
  if (about.UnitFlag() > 0 && about.UnitFlag() != kNamedUnit && about.UnitValue() > 0) {
    unit = about.UnitValue();
    set_unit(model, unit, true);
  }
  model.tolerance = std::max(0.0, about.Resolution());
  auto document = make_document(unit);
  if (!reader.Transfer(document))
    throw InvalidCad("expected an IGES file with shapes, got one of which OpenCASCADE makes none");
  add_document(document, {}, model);
  return model;
}

CadModel read_brep(const std::string& path) {
  std::string start(64, '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  TopoDS_Shape shape;
  const bool is_binary = start.find("Open CASCADE Topology V") != std::string::npos;
  bool is_read = false;
  if (is_binary) is_read = BinTools::Read(shape, path.c_str());
  else if (start.find("DBRep_DrawableShape") != std::string::npos || start.find("CASCADE") != std::string::npos)
    is_read = BRepTools::Read(shape, path.c_str(), BRep_Builder());
  if (!is_read || shape.IsNull())
    throw InvalidCad("expected a BREP file of OpenCASCADE's, got one that it cannot read");
  CadModel model;
  add_shape(shape, model);
  return model;
}

std::vector<std::uint32_t> shells_of(const Body& body) {
  DisjointSets joined(body.faces.size());
  TopTools_IndexedMapOfShape edges;
  std::vector<std::uint32_t> first_face;  // of each edge
  for (std::uint32_t f = 0; f < body.faces.size(); ++f) {
    TopTools_IndexedMapOfShape own;
    TopExp::MapShapes(body.faces[f].face, TopAbs_EDGE, own);
    for (int e = 1; e <= own.Extent(); ++e) {
      const auto number = static_cast<std::size_t>(edges.Add(own(e)));
      if (number > first_face.size()) first_face.push_back(f);
      else joined.join(f, first_face[number - 1]);
    }
  }
  return std::move(joined).firsts();
}

CadModel read_model(const std::string& path, const std::string& format) {
  CadModel model = format == "step" ? read_step(path) : format == "iges" ? read_iges(path) : read_brep(path);
  if (!model.bodies.empty()) return model;
  std::string others;
  for (const std::string& extra : model.extras) others += (others.empty() ? "" : ", ") + extra;
  const std::string name = format == "step" ? "a STEP file" : format == "iges" ? "an IGES file" : "a BREP file";
  throw InvalidCad("expected " + name + " with faces, got no face" + (others.empty() ? "" : " (" + others + ")"));
}

}  // namespace vdb_offset::cad
