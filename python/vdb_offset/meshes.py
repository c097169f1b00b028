# SPDX-License-Identifier: Apache-2.0
"""The meshes of other packages, by what they have, not by their classes: nothing is imported that is not there."""

import copy
from typing import Any, Tuple

import numpy as np

from . import _options
from ._calls import offset
from ._options import Distance, Faces, takes
from ._results import Offset


def _from_counts(cells: np.ndarray) -> Faces:
    """Faces out of VTK's array: of each the number of its corners, and these."""
    cells = np.asarray(cells)
    if cells.size == 0:
        return np.zeros((0, 3), np.uint32)
    size = int(cells[0])
    if size < 0:
        raise ValueError(f"faces: expected numbers of corners, got {size}")
    if cells.size % (size + 1) == 0 and (cells.reshape(-1, size + 1)[:, 0] == size).all():
        return cells.reshape(-1, size + 1)[:, 1:]
    sizes, at = [], 0
    while at < cells.size:
        sizes.append(int(cells[at]))
        if sizes[-1] < 0:
            raise ValueError(f"faces: expected numbers of corners, got {sizes[-1]}")
        at += sizes[-1] + 1
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    is_corner = np.ones(cells.size, bool)
    is_corner[offsets[:-1] + np.arange(len(sizes))] = False
    return offsets, cells[is_corner]


def _from_blocks(blocks: Any) -> Faces:
    """Faces out of meshio's blocks of cells: triangles, quads and polygons; others are no faces."""
    data = [np.asarray(block.data) for block in blocks if block.type in ("triangle", "quad") or block.type.startswith("polygon")]
    if not data:
        return np.zeros((0, 3), np.uint32)
    if len(data) == 1:
        return data[0]
    sizes = np.concatenate([np.full(len(block), block.shape[1]) for block in data])
    return np.concatenate([[0], np.cumsum(sizes)]), np.concatenate([block.ravel().astype(np.int64) for block in data])


def arrays_of(mesh: Any) -> Tuple[np.ndarray, Faces]:
    """The vertices and faces of a mesh of trimesh, PyVista, VTK, meshio or Open3D, for the functions of this module.

    :raises TypeError: for anything else
    """
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh, whose triangles are positions
        return np.asarray(mesh.vertices), np.asarray(mesh.faces)
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):  # Open3D
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    if hasattr(mesh, "points") and hasattr(mesh, "cells") and isinstance(mesh.cells, list):  # meshio
        return np.asarray(mesh.points), _from_blocks(mesh.cells)
    if hasattr(mesh, "points") and hasattr(mesh, "faces"):  # PyVista
        return np.asarray(mesh.points), _from_counts(mesh.faces)
    if hasattr(mesh, "GetPoints") and hasattr(mesh, "GetPolys"):  # VTK
        from vtkmodules.util.numpy_support import vtk_to_numpy

        polys = mesh.GetPolys()
        if mesh.GetPoints() is None:
            return np.zeros((0, 3)), np.zeros((0, 3), np.uint32)
        return vtk_to_numpy(mesh.GetPoints().GetData()), (vtk_to_numpy(polys.GetOffsetsArray()),
                                                          vtk_to_numpy(polys.GetConnectivityArray()))
    raise TypeError(f"expected a mesh of trimesh, PyVista, VTK, meshio or Open3D, got {type(mesh).__name__}")


def with_positions(mesh: Any, positions: np.ndarray) -> Any:
    """A copy of a mesh of one of these packages with its vertices elsewhere, and all else as it was.

    :param positions: (n, 3), one for each vertex
    :raises TypeError: for anything else
    """
    if hasattr(mesh, "GetPoints") and hasattr(mesh, "GetPolys") and not hasattr(mesh, "points"):  # VTK
        from vtkmodules.util.numpy_support import numpy_to_vtk
        from vtkmodules.vtkCommonCore import vtkPoints

        moved = mesh.NewInstance()
        moved.DeepCopy(mesh)
        points = vtkPoints()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(positions), deep=True))
        moved.SetPoints(points)
        return moved
    moved = mesh.copy() if hasattr(mesh, "copy") else copy.deepcopy(mesh)
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh
        moved.vertices = positions
    elif hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):  # Open3D
        moved.vertices = type(mesh.vertices)(positions)
    elif hasattr(mesh, "points"):
        moved.points = positions
    else:
        raise TypeError(f"expected a mesh of trimesh, PyVista, VTK, meshio or Open3D, got {type(mesh).__name__}")
    return moved


@takes(_options.OFFSET)
def offset_mesh(mesh: Any, distance: Distance, **options: Any) -> Tuple[Any, Offset]:
    """Offsets a mesh of trimesh, PyVista, VTK, meshio or Open3D.

    :param distance: see the module
    :param options: by keyword; `help()` describes each
    :return: a copy of the mesh with its vertices moved, and what `offset()` returns
    :raises TypeError: for anything else, and as `offset()`
    """
    vertices, faces = arrays_of(mesh)
    result = offset(vertices, faces, distance, **options)
    return with_positions(mesh, result.positions), result
