// SPDX-License-Identifier: Apache-2.0
// Keeps a data set of VTK's with all its arrays, to write the file again with other positions. If nothing has moved,
// the file keeps all of its bytes. A legacy file has numbers replaced where they stand; only if they are not found
// there it becomes a new binary file, and its layout is named as lost. An XML file is written by VTK as it was made: as
// text, binary or appended, with its byte order and compressor. All arrays other than points and normals pass through
// as they are. For other formats, normals, texture coordinates and colours are taken from point arrays, and names of
// faces from cell arrays under the names that programs use. What VTK complains of becomes an error with the file's
// name.
#include "vtk/module/vtk_document.h"

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkErrorCode.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "bytes/nearest_names.h"
#include "vdb_offset/run.h"
#include "vtk/module/vtk_complaint.h"

namespace vdb_offset::io {
namespace {

Pieces whole(std::string bytes) {
  const auto shared = std::make_shared<const std::string>(std::move(bytes));
  return {1, [shared](std::size_t) { return *shared; }};
}

std::string name_of(vtkAbstractArray* array) { return array->GetName() ? array->GetName() : ""; }

bool has_floats(vtkDataArray& array) { return array.GetDataType() == VTK_FLOAT || array.GetDataType() == VTK_DOUBLE; }

/// A copy of an array with other values at the vertices for which there is one.
template <class ValueOf>
vtkSmartPointer<vtkDataArray> with_values(vtkDataArray& array, ValueOf&& value_of) {
  auto copy = vtkSmartPointer<vtkDataArray>::Take(array.NewInstance());
  copy->DeepCopy(&array);
  for (vtkIdType v = 0; v < copy->GetNumberOfTuples(); ++v)
    if (const std::optional<Vec3d> value = value_of(static_cast<std::size_t>(v)))
      copy->SetTuple3(v, (*value)[0], (*value)[1], (*value)[2]);
  return copy;
}

std::string xml_of(vtkXMLWriter& writer, vtkPointSet& data, const VtkHeader& header, const std::string& path) {
  const VtkComplaint complaint;
  writer.SetInputDataObject(&data);
  if (header.ascii) writer.SetDataModeToAscii();
  else if (header.appended) writer.SetDataModeToAppended();
  else writer.SetDataModeToBinary();
  writer.SetEncodeAppendedData(header.base64);
  if (header.big_endian) writer.SetByteOrderToBigEndian();
  else writer.SetByteOrderToLittleEndian();
  constexpr unsigned long kNarrow = 1u << 20;  // KiB; far below what counts of 32 bits can resolve
  if (header.wide_counts || data.GetActualMemorySize() > kNarrow) writer.SetHeaderTypeToUInt64();
  else writer.SetHeaderTypeToUInt32();
  if (header.compressor == "vtkZLibDataCompressor") writer.SetCompressorTypeToZLib();
  else if (header.compressor == "vtkLZ4DataCompressor") writer.SetCompressorTypeToLZ4();
  else if (header.compressor == "vtkLZMADataCompressor") writer.SetCompressorTypeToLZMA();
  else writer.SetCompressorTypeToNone();
  writer.WriteToOutputStringOn();
  if (writer.Write() == 0 || writer.GetErrorCode() != vtkErrorCode::NoError || !complaint.empty())
    throw WriteError(
        path + ": cannot be written: " +
        (complaint.empty() ? vtkErrorCode::GetStringFromErrorCode(writer.GetErrorCode()) : complaint.in_short()));
  return writer.GetOutputString();
}

template <class Writer>
std::string legacy_of(vtkPointSet& data, const std::string& path) {
  const VtkComplaint complaint;
  const auto writer = vtkSmartPointer<Writer>::New();
  writer->SetInputData(&data);
  writer->SetFileTypeToBinary();
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0 || !complaint.empty())
    throw WriteError(path + ": cannot be written: " + complaint.in_short());
  return writer->GetOutputStdString();
}

/// The colours of points: bytes, three or four for each, under a name that programs have for them.
vtkUnsignedCharArray* find_colours(vtkPointData& points) {
  const auto as_colours = [](vtkAbstractArray* array) {
    auto* const bytes = vtkUnsignedCharArray::SafeDownCast(array);
    return bytes && (bytes->GetNumberOfComponents() == 3 || bytes->GetNumberOfComponents() == 4) ? bytes : nullptr;
  };
  if (auto* const active = as_colours(points.GetScalars())) return active;
  for (const char* const name : {"Colors", "colors", "RGB", "RGBA", "rgb", "rgba"})
    if (auto* const colours = as_colours(points.GetAbstractArray(name))) return colours;
  return nullptr;
}

void read_colours(vtkPointData& points, Attributes& attributes) {
  vtkUnsignedCharArray* const array = find_colours(points);
  if (!array) return;
  attributes.has_alpha = array->GetNumberOfComponents() == 4;
  attributes.colours.assign(static_cast<std::size_t>(array->GetNumberOfTuples()), {0, 0, 0, 1});
  for (std::size_t v = 0; v < attributes.colours.size(); ++v)
    for (int k = 0; k < array->GetNumberOfComponents(); ++k)
      attributes.colours[v][static_cast<std::size_t>(k)] =
          array->GetTypedComponent(static_cast<vtkIdType>(v), k) / 255.0;
  std::erase(attributes.lost, "point array '" + name_of(array) + "'");
}

void read_texture(vtkPointData& points, Attributes& attributes) {
  vtkDataArray* const array = points.GetTCoords();
  if (!array || !has_floats(*array) || array->GetNumberOfComponents() < 2) return;
  std::vector<Vec2d> texture(static_cast<std::size_t>(array->GetNumberOfTuples()));
  for (std::size_t v = 0; v < texture.size(); ++v) {
    const auto at = static_cast<vtkIdType>(v);
    texture[v] = {array->GetComponent(at, 0), array->GetComponent(at, 1)};
    if (!texture[v].isFinite()) return;
  }
  attributes.texture.value = std::move(texture);
  attributes.texture.single = array->GetDataType() == VTK_FLOAT;
  if (array->GetNumberOfComponents() == 2) std::erase(attributes.lost, "point array '" + name_of(array) + "'");
}

void add_names(vtkFieldData* fields, const char* kind, std::vector<std::string>& words) {
  for (int i = 0; fields && i < fields->GetNumberOfArrays(); ++i)
    words.push_back(fmt::format("{} array '{}'", kind, name_of(fields->GetAbstractArray(i))));
}

}  // namespace

VtkDocument::VtkDocument(VtkHeader header, vtkSmartPointer<vtkPointSet> data, std::vector<std::int64_t> cell)
    : header_(std::move(header)), data_(std::move(data)), cell_(std::move(cell)) {}

vtkDataArray* VtkDocument::normals() const {
  vtkPointData& points = *data_->GetPointData();
  for (vtkDataArray* const array : {points.GetNormals(), points.GetArray("Normals")})
    if (array && has_floats(*array) && array->GetNumberOfComponents() == 3 &&
        array->GetNumberOfTuples() == data_->GetNumberOfPoints())
      return array;
  return nullptr;
}

std::vector<std::string> VtkDocument::arrays_in_words() const {
  std::vector<std::string> words;
  add_names(data_->GetPointData(), "point", words);
  add_names(data_->GetCellData(), "cell", words);
  add_names(data_->GetFieldData(), "field", words);
  return words;
}

WrittenDocument VtkDocument::rewrite(const MovedMesh& moved) const {
  if (!moved.any_has_moved()) return {whole(std::string(moved.source.text())), {}, {}};
  const auto points = with_values(*data_->GetPoints()->GetData(), [&](std::size_t v) -> std::optional<Vec3d> {
    if (moved.has_moved(v)) return moved.precision(moved.positions[v]);
    return std::nullopt;
  });
  const auto copy = vtkSmartPointer<vtkPointSet>::Take(data_->NewInstance());
  copy->ShallowCopy(data_);
  const auto placed = vtkSmartPointer<vtkPoints>::New();
  placed->SetData(points);
  copy->SetPoints(placed);
  vtkSmartPointer<vtkDataArray> turned;
  if (normals() && !moved.normals->value.empty()) {
    turned = with_values(*normals(), [&](std::size_t v) -> std::optional<Vec3d> {
      const Vec3d& normal = moved.normals->value[v];
      return normal.lengthSqr() > 0 ? std::optional(normal) : std::nullopt;
    });
    turned->SetName(normals()->GetName());
    copy->GetPointData()->AddArray(turned);
  }
  if (header_.legacy) {
    if (auto bytes = rewrite_legacy(moved.source, header_.ascii, *data_, *copy, normals(), turned))
      return {whole(*std::move(bytes)), {}, {}};
  }
  return as_new_file(*copy, moved.path);
}

WrittenDocument VtkDocument::as_new_file(vtkPointSet& data, const std::string& path) const {
  // Of a legacy file in a layout in which numbers are not found: binary, as VTK's texts have too few digits.
  if (header_.legacy)
    return {whole(header_.grid ? legacy_of<vtkUnstructuredGridWriter>(data, path)
                               : legacy_of<vtkPolyDataWriter>(data, path)),
            {},
            {"the layout of the text"}};
  if (header_.grid)
    return {whole(xml_of(*vtkSmartPointer<vtkXMLUnstructuredGridWriter>::New(), data, header_, path)), {}, {}};
  return {whole(xml_of(*vtkSmartPointer<vtkXMLPolyDataWriter>::New(), data, header_, path)), {}, {}};
}

void VtkDocument::read_attributes(const MeshFile&, Attributes& attributes) const {
  vtkPointData& points = *data_->GetPointData();
  if (vtkDataArray* const array = normals()) {
    attributes.normals.value.resize(static_cast<std::size_t>(array->GetNumberOfTuples()));
    for (std::size_t v = 0; v < attributes.normals.value.size(); ++v)
      array->GetTuple(static_cast<vtkIdType>(v), attributes.normals.value[v].asPointer());
    attributes.normals.single = array->GetDataType() == VTK_FLOAT;
    std::erase(attributes.lost, "point array '" + name_of(array) + "'");
  }
  read_texture(points, attributes);
  read_colours(points, attributes);
}

FaceNames VtkDocument::face_names() const {
  FaceNames names;
  vtkCellData& cells = *data_->GetCellData();
  for (const char* const name : {"group", "part", "GroupIds", "PartId", "material", "MaterialIds"}) {
    vtkAbstractArray* const array = cells.GetAbstractArray(name);
    if (!array || array->GetNumberOfComponents() != 1) continue;
    std::map<std::string, std::uint32_t> index_of;
    for (const std::int64_t cell : cell_) {
      const std::string text = array->GetVariantValue(cell).ToString();
      const auto [known, is_new] = index_of.try_emplace(text, static_cast<std::uint32_t>(names.groups.size()));
      if (is_new) names.groups.push_back(text);
      names.group_of.push_back(known->second);
    }
    break;
  }
  return names;
}

std::vector<double> VtkDocument::vertex_numbers(const MeshFile& source, const std::string& name) const {
  vtkPointData& points = *data_->GetPointData();
  vtkDataArray* const array = points.GetArray(name.c_str());
  if (!array || array->GetNumberOfComponents() != 1) {
    std::vector<std::string> known;
    for (int i = 0; i < points.GetNumberOfArrays(); ++i)
      if (vtkDataArray* const each = points.GetArray(i); each && each->GetNumberOfComponents() == 1)
        known.push_back(name_of(each));
    throw InvalidInput(
        known.empty() ? fmt::format("{}: expected a point array '{}' of single numbers, found none", source.path, name)
                      : fmt::format("{}: expected a point array of single numbers among {}, got '{}'", source.path,
                                    nearest_names(name, known), name));
  }
  std::vector<double> numbers(source.polygons.positions.size());
  for (std::size_t v = 0; v < numbers.size(); ++v) {
    numbers[v] = array->GetComponent(static_cast<vtkIdType>(v), 0);
    if (!std::isfinite(numbers[v]))
      throw InvalidInput(fmt::format("{}: point array '{}': expected finite numbers, got {} at vertex {}", source.path,
                                     name, numbers[v], v));
  }
  return numbers;
}

}  // namespace vdb_offset::io
