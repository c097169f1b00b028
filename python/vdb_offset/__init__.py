# SPDX-License-Identifier: Apache-2.0
"""Offsets meshes by a distance, and keeps their vertices and faces.

>>> import numpy as np, vdb_offset
>>> vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
>>> faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
>>> result = vdb_offset.offset(vertices, faces, 0.1, corners="miter")
>>> result.positions.shape, result.state_names[0]
((4, 3), 'mitered')
>>> np.round(result.positions[0], 9).tolist()
[-0.1, -0.1, -0.1]

Meshes are two arrays: `vertices`, (n, 3) numbers, and `faces`, (m, k) integers, or for polygons a pair of arrays: m + 1
offsets, which rise from 0, and the corners that they divide. Arrays of doubles, and of 32-bit unsigned integers, that
are contiguous are not copied. For the meshes of trimesh, PyVista, VTK, meshio and Open3D see `offset_mesh()`.

A `distance` is a number in world units, negative inward; an array with one for each vertex; or a text as the command
takes it: "1%" of the diagonal of the bounding box, or an expression, "0.1 + 0.05*sin(4*pi*z)". With `unit`, what the
numbers of the arrays are, lengths may have one of their own: "0.2mm".

Errors are classes of this module's: `InvalidInput` and `InvalidOption` are ValueErrors, `OutOfBudget` is a MemoryError,
`InvalidResult`, of an iso-surface that is not valid, is a RuntimeError with the surface's `statistics`, and all of them
are `Error`. `progress` is called with the name of the stage at hand and the share of the call that is done, 0 to 1; if
it returns False the call raises `Cancelled`, and what it raises itself is raised by the call. So is Ctrl-C. `reserve`
is called with the bytes that the run is estimated to hold at most, before it takes them. It may wait until there is room
for them; Ctrl-C ends the call once it returns. It cancels and raises as `progress` does.
"""

from ._calls import (
    check,
    check_curves,
    curve_layers,
    fit,
    height_of_y_plus,
    iso_shell,
    iso_surface,
    iso_surface_several,
    layers,
    offset,
    offset_curves,
    offset_curves_several,
    offset_several,
    offset_to_tolerance,
    shell,
    shell_several,
    structured_curve_layers,
    structured_layers,
)
from ._core import (
    Cancelled,
    Error,
    InvalidExpression,
    InvalidInput,
    InvalidOption,
    InvalidResult,
    OutOfBudget,
    states as STATES,
    version as __version__,
)
from ._results import Block, Check, Iso, IsoShell, Layers, Offset, Refined, Shell
from .meshes import arrays_of, offset_mesh, with_positions

__all__ = [
    "Block", "Cancelled", "Check", "Error", "InvalidExpression", "InvalidInput", "InvalidOption",
    "InvalidResult", "Iso", "IsoShell", "Layers", "Offset", "OutOfBudget", "Refined", "STATES", "Shell", "arrays_of", "check", "check_curves",
    "curve_layers", "fit", "height_of_y_plus", "iso_shell", "iso_surface", "iso_surface_several", "layers", "offset",
    "offset_curves", "offset_curves_several", "offset_mesh", "offset_several", "offset_to_tolerance", "shell", "shell_several",
    "structured_curve_layers", "structured_layers", "with_positions",
]
