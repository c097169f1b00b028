// SPDX-License-Identifier: Apache-2.0
// Writes groups, and curves as a DXF file of their own.
#include "dxf/dxf_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "bytes/append_number.h"
#include "dxf/dxf.h"

namespace vdb_offset::io {

void DxfWriter::code(int code) {
  text_ += fmt::format("{:3}", code);
  text_ += line_end_;
}

void DxfWriter::group(int code, std::string_view value) {
  this->code(code);
  text_ += value;
  text_ += line_end_;
}

void DxfWriter::group(int code, double value, const Rounding& precision) {
  this->code(code);
  append_number(text_, precision(value), precision);
  text_ += line_end_;
}

void DxfWriter::flags(int code, int value) { group(code, fmt::format("{:6}", value)); }

void DxfWriter::point(int code, const Vec3d& p, const Rounding& precision) {
  for (int k = 0; k < 3; ++k) group(code + 10 * k, p[k], precision);
}

std::string as_dxf(CurvesView curves, const Rounding& precision) {
  Vec3d lower(0.0), upper(0.0);
  for (std::size_t i = 0; i < curves.corners.size(); ++i) {
    const Vec3d& p = curves.positions[curves.corners[i]];
    lower = i == 0 ? p : openvdb::math::minComponent(lower, p);
    upper = i == 0 ? p : openvdb::math::maxComponent(upper, p);
  }
  std::string text;
  DxfWriter writer(text);
  const auto groups = [&](std::initializer_list<std::pair<int, std::string_view>> each) {
    for (const auto& [code, value] : each) writer.group(code, value);
  };
  groups({{0, "SECTION"}, {2, "HEADER"}, {9, "$ACADVER"}, {1, "AC1009"}, {9, "$EXTMIN"}});
  writer.point(10, lower, precision);
  groups({{9, "$EXTMAX"}});
  writer.point(10, upper, precision);
  groups({{0, "ENDSEC"},  {0, "SECTION"},    {2, "TABLES"}, {0, "TABLE"},      {2, "LTYPE"},   {70, "1"},
          {0, "LTYPE"},   {2, "CONTINUOUS"}, {70, "0"},     {3, "Solid line"}, {72, "65"},     {73, "0"},
          {40, "0.0"},    {0, "ENDTAB"},     {0, "TABLE"},  {2, "LAYER"},      {70, "1"},      {0, "LAYER"},
          {2, "0"},       {70, "0"},         {62, "7"},     {6, "CONTINUOUS"}, {0, "ENDTAB"},  {0, "ENDSEC"},
          {0, "SECTION"}, {2, "BLOCKS"},     {0, "ENDSEC"}, {0, "SECTION"},    {2, "ENTITIES"}});
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    const auto points = curves.face(c);
    if (points.size() < 2) continue;  // readers expect two points at least
    const auto at = [&](std::size_t k) { return curves.positions[points[k]]; };
    const bool closed = points.size() > 3 && at(points.size() - 1) == at(0);
    bool in_plane = true;
    for (std::size_t k = 1; k < points.size(); ++k) in_plane = in_plane && at(k)[2] == at(0)[2];
    groups({{0, "POLYLINE"}, {8, "0"}, {66, "1"}});
    writer.point(10, {0, 0, in_plane ? at(0)[2] : 0}, precision);
    writer.flags(70, (closed ? 1 : 0) | (in_plane ? 0 : 8));
    for (std::size_t k = 0; k < points.size() - closed; ++k) {
      groups({{0, "VERTEX"}, {8, "0"}});
      writer.point(10, at(k), precision);
      if (!in_plane) writer.flags(70, 32);
    }
    groups({{0, "SEQEND"}, {8, "0"}});
  }
  groups({{0, "ENDSEC"}, {0, "EOF"}});
  return text;
}

}  // namespace vdb_offset::io
