// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "svg/svg.h"
#include "svg/svg_document.h"

namespace vdb_offset::io {

/// The shapes of a drawing as they are drawn, without their curves, and what `use` shows. \throw as parse_svg()
SvgDrawing resolve_uses(const SvgDocument& document);

}  // namespace vdb_offset::io
