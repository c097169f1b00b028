// SPDX-License-Identifier: Apache-2.0
#include "read/name_instances.h"

#include <STEPConstruct_Tool.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_SpecifiedHigherUsageOccurrence.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_GraphNode.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>

#include <string_view>

namespace vdb_offset::cad {
namespace {

constexpr int kMostLevels = 100;  // of assemblies in assemblies; broken files may refer to themselves

/// Gives the name of an instance, or an empty text. Programs put it into the description, the name, or both; with
/// `=>[0:1:1:2]` OpenCASCADE names what has no name.
TCollection_ExtendedString instance_name(const StepBasic_ProductDefinitionRelationship& use) {
  for (const auto& text : {use.HasDescription() ? use.Description() : nullptr, use.Name()})
    if (!text.IsNull() && text->UsefullLength() > 0 && !std::string_view(text->ToCString()).starts_with("=>["))
      return {text->ToCString(), Standard_True};
  return {};
}

class InstanceNames {
 public:
  InstanceNames(const STEPCAFControl_Reader& reader, const opencascade::handle<TDocStd_Document>& document)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        session_(reader.Reader().WS()),
        labels_(reader.GetShapeLabelMap()) {}

  void set() const {
    const auto& entities = session_->Model();
    for (int k = 1; k <= entities->NbEntities(); ++k) {
      const auto entity = entities->Value(k);
      if (const auto use = opencascade::handle<StepRepr_NextAssemblyUsageOccurrence>::DownCast(entity); !use.IsNull())
        name_use(use);
      else if (const auto nested = opencascade::handle<StepRepr_SpecifiedHigherUsageOccurrence>::DownCast(entity);
               !nested.IsNull())
        name_nested(*nested);
    }
  }

 private:
  TDF_Label label_of(const opencascade::handle<StepRepr_NextAssemblyUsageOccurrence>& use) const {
    if (use.IsNull()) return {};
    const TDF_Label label = STEPCAFControl_Reader::FindInstance(use, shapes_, STEPConstruct_Tool(session_), labels_);
    return !label.IsNull() && XCAFDoc_ShapeTool::IsComponent(label) ? label : TDF_Label();
  }

  void name_use(const opencascade::handle<StepRepr_NextAssemblyUsageOccurrence>& use) const {
    const TDF_Label label = label_of(use);
    if (label.IsNull()) return;
    const TCollection_ExtendedString name = instance_name(*use);
    if (name.IsEmpty()) label.ForgetAttribute(TDataStd_Name::GetID());
    else TDataStd_Name::Set(label, name);
  }

  void name_nested(const StepRepr_SpecifiedHigherUsageOccurrence& nested) const {
    const TCollection_ExtendedString name = instance_name(nested);
    TDF_LabelSequence path;
    if (name.IsEmpty() || !find_path(nested, path)) return;
    opencascade::handle<XCAFDoc_GraphNode> found;
    if (!XCAFDoc_ShapeTool::FindSHUO(path, found)) shapes_->SetSHUO(path, found);
    if (!found.IsNull()) TDataStd_Name::Set(found->Label(), name);
  }

  /// The instances from the outermost one in; false if one of them is not in the document.
  bool find_path(const StepRepr_SpecifiedHigherUsageOccurrence& nested, TDF_LabelSequence& path) const {
    path.Append(label_of(nested.NextUsage()));
    auto upper = nested.UpperUsage();
    for (int level = 0; level < kMostLevels && !upper.IsNull(); ++level) {
      const auto further = opencascade::handle<StepRepr_SpecifiedHigherUsageOccurrence>::DownCast(upper);
      path.Prepend(label_of(further.IsNull()
                                ? opencascade::handle<StepRepr_NextAssemblyUsageOccurrence>::DownCast(upper)
                                : further->NextUsage()));
      if (path.First().IsNull()) return false;
      upper = further.IsNull() ? nullptr : further->UpperUsage();
    }
    return upper.IsNull() && path.Length() > 1 && !path.Last().IsNull();
  }

  opencascade::handle<XCAFDoc_ShapeTool> shapes_;
  opencascade::handle<XSControl_WorkSession> session_;
  const XCAFDoc_DataMapOfShapeLabel& labels_;
};

}  // namespace

void name_instances(const STEPCAFControl_Reader& reader, const opencascade::handle<TDocStd_Document>& document) {
  InstanceNames(reader, document).set();
}

}  // namespace vdb_offset::cad
