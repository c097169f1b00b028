// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <TDocStd_Document.hxx>

namespace vdb_offset::cad {

/// Gives the placed parts and assemblies of a document the names that a STEP file has for them, and no others:
/// OpenCASCADE's reader takes their numbers for names where there are none, and leaves out the names of those that are
/// meant in one of the places of the assembly that they are in (`specified higher usage occurrence`).
void name_instances(const STEPCAFControl_Reader& reader, const opencascade::handle<TDocStd_Document>& document);

}  // namespace vdb_offset::cad
