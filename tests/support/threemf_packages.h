// SPDX-License-Identifier: Apache-2.0
// 3MF packages as programs write them.
#pragma once

#include <string>
#include <vector>

#include "support/zip_file.h"

inline const std::string kContentTypes =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
    " <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
    " <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
    " <Default Extension=\"png\" ContentType=\"image/png\"/>\n</Types>";
inline const std::string kRelationships =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
    " <Relationship Target=\"/Metadata/thumbnail.png\" Id=\"rel-2\""
    " Type=\"http://schemas.openxmlformats.org/package/2006/relationships/metadata/thumbnail\"/>\n"
    " <Relationship Target=\"/3D/3dmodel.model\" Id=\"rel-1\""
    " Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n</Relationships>";
inline const std::string kCoreSpace = "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"";

/// A tetrahedron with corners at 0 and on the axes.
inline const std::string kTetrahedronXml =
    "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"4\" y=\"0\" z=\"0\"/><vertex x=\"0\" y=\"4\" "
    "z=\"0\"/>"
    "<vertex x=\"0\" y=\"0\" z=\"4\"/></vertices><triangles><triangle v1=\"0\" v2=\"2\" v3=\"1\"/>"
    "<triangle v1=\"0\" v2=\"1\" v3=\"3\"/><triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"2\" v2=\"0\" v3=\"3\"/>"
    "</triangles></mesh>";

inline std::string model_of(const std::string& resources, const std::string& build,
                            const std::string& attributes = {}) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model " + kCoreSpace + " " + attributes + ">\n<resources>" +
         resources + "</resources>\n<build>" + build + "</build>\n</model>\n";
}

/// A model part in the least package.
inline std::string package_of(const std::string& model) {
  return zip_file(
      {{"[Content_Types].xml", kContentTypes}, {"_rels/.rels", kRelationships}, {"3D/3dmodel.model", model}});
}
