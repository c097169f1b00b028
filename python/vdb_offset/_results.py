# SPDX-License-Identifier: Apache-2.0
"""What the functions return."""

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _core
from ._options import Faces

# meshio's names of VTK's cell types.
_MESHIO_NAMES = {5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron", 13: "wedge", 14: "pyramid"}


@dataclass(frozen=True, eq=False)
class _Vertices:
    """What became of the vertices. Each array has a value for each vertex of the input, in its order."""

    #: (n,) integers: indices into `STATES`, what became of each vertex.
    states: np.ndarray
    #: (n,) exact distances to the input, world units.
    achieved: np.ndarray
    #: The report of the run, as the command writes it with `--report`.
    statistics: Mapping[str, Any]

    @property
    def state_names(self) -> List[str]:
        """The states as words, one for each vertex."""
        return [_core.states[state] for state in self.states]

    @property
    def reached(self) -> float:
        """The share of the vertices in use that have reached their distance, or the end of their miter, cut or not; 1 if
        there are none. As the command counts them."""
        counts = np.bincount(self.states, minlength=len(_core.states))
        used = counts.sum() - counts[_core.states.index("unused")]
        return 1.0 if used == 0 else float(counts[[_core.states.index(s) for s in ("reached", "mitered", "cut")]].sum() / used)


@dataclass(frozen=True, eq=False)
class Offset(_Vertices):
    """An offset: where each vertex of the input is."""

    #: (n, 3) positions, world units, in the order of the input's vertices.
    positions: np.ndarray
    #: (n,) distances that were asked for.
    distances: np.ndarray
    #: With `paths=True`, of each vertex the (k, 3) positions on its way; else None.
    paths: Optional[List[np.ndarray]]
    #: With `face_errors=True`, (m,) of each face of the input how far it is off its distance, as a share of that: NaN
    #: where nothing is asked. Else None.
    face_errors: Optional[np.ndarray]


@dataclass(frozen=True, eq=False)
class Refined(Offset):
    """An offset whose faces were split until they are proven to be at the distance. The vertices of the input come
    first, in their order, then the ones that were added; all arrays have a value for each of both."""

    #: (v, 3) positions in the source, which pair with `positions`.
    source: np.ndarray
    #: The faces, (m, k) or a pair of offsets and corners, and (m,) the input's faces that they are pieces of. With
    #: corners="arc" the input's faces come first, then those over sharp edges, each with a face beside it.
    faces: Faces
    parents: np.ndarray
    #: Of each added vertex: `faces` (a,), a face of the input that it lies on, `vertices` (a, 3), corners of that, and
    #: `shares` (a, 3), how much of each it is.
    added: Mapping[str, np.ndarray]


@dataclass(frozen=True, eq=False)
class Shell(_Vertices):
    """A solid between two skins, and rims along open borders."""

    #: (v, 3) positions: of the outer skin, in the order of the input's vertices, of the inner skin, and of corners that
    #: have more of them.
    vertices: np.ndarray
    #: The faces, (m, k) or a pair of offsets and corners.
    faces: Faces
    #: (m,) integers: 0 for a face of the outer skin, 1 of the inner one, 2 of a rim.
    parts: np.ndarray
    #: (m,) numbers of the input's faces that these come from.
    source_faces: np.ndarray
    #: With `paths=True`, of each vertex of the input the (k, 3) positions on its way to the outer skin; else None.
    paths: Optional[List[np.ndarray]]
    #: With `face_errors=True`, (m,) of each face of the input how far that of the outer skin is off; else None.
    face_errors: Optional[np.ndarray]


@dataclass(frozen=True, eq=False)
class Layers(_Vertices):
    """Layers of cells, as VTK names their parts: pyvista.UnstructuredGrid(cells, cell_types, points)."""

    #: (p, 3) positions.
    points: np.ndarray
    #: One-dimensional: of each cell the length of what follows, and its points.
    cells: np.ndarray
    #: (c,) VTK's numbers of cell types.
    cell_types: np.ndarray
    #: Arrays by name, with a value for each point or cell.
    point_data: Mapping[str, np.ndarray]
    cell_data: Mapping[str, np.ndarray]
    #: Faces of the boundary by the name of their patch: offsets and points.
    patches: Mapping[str, Tuple[np.ndarray, np.ndarray]]
    #: (n,) of each vertex of the input the share of its heights that it keeps.
    share: np.ndarray

    def numbers_by_type(self) -> Dict[str, np.ndarray]:
        """The numbers of the cells of each type, by meshio's names of the types: indices into `cell_data`."""
        numbers = {name: np.flatnonzero(self.cell_types == number) for number, name in _MESHIO_NAMES.items()}
        return {name: some for name, some in numbers.items() if len(some)}

    def by_type(self) -> Dict[str, np.ndarray]:
        """Cells by meshio's names of their types, each (c, k) points in meshio's order.

        `meshio.Mesh(layers.points, list(layers.by_type().items()))` is a mesh of it.

        :raises ValueError: if there are polyhedra, which have no such array
        """
        if (self.cell_types == 42).any():
            raise ValueError("by_type: expected cells of up to 8 corners, got polyhedra")
        # Where each cell begins: its length tells where the next one does.
        begins = np.empty(len(self.cell_types), np.int64)
        at = 0
        for i in range(len(begins)):
            begins[i] = at
            at += self.cells[at] + 1
        cells = {}
        for name, numbers in self.numbers_by_type().items():
            first = begins[numbers]
            size = int(self.cells[first[0]])
            cells[name] = self.cells[first[:, None] + np.arange(1, size + 1)]
        if "wedge" in cells:  # VTK has prisms the other way round
            cells["wedge"] = cells["wedge"][:, [0, 2, 1, 3, 5, 4]]
        return cells


@dataclass(frozen=True, eq=False)
class Block(_Vertices):
    """Layers as a structured block: pyvista.StructuredGrid(*block.points.T)."""

    #: (nk, nj, ni, 3) positions: i and j over the grid, k from the wall outward. On a curve nk is 1, i runs along it and
    #: j from the wall outward.
    points: np.ndarray
    #: (nk, nj, ni) arrays by name.
    point_data: Mapping[str, np.ndarray]
    #: (n,) of each vertex of the input the share of its heights that it keeps.
    share: np.ndarray


@dataclass(frozen=True, eq=False)
class Iso:
    """An iso-surface: a new mesh, closed and manifold."""

    #: (v, 3) positions, and (v, 3) directions away from the input, of unit length.
    vertices: np.ndarray
    normals: np.ndarray
    #: (m, 3) corners, or a pair of offsets and corners.
    faces: Faces
    #: The report of the run, as the command writes it with `--report`.
    statistics: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class IsoShell:
    """A hollow solid: a surface, and the surface of its cavity turned round."""

    #: (v, 3) positions: of the outer surface, then of the cavity's.
    vertices: np.ndarray
    #: (m, 3) corners, or a pair of offsets and corners.
    faces: Faces
    #: (m,) integers: 0 for a face of the outer surface, 1 of the cavity's.
    parts: np.ndarray
    #: The report of the run, as the command writes it with `--report`.
    statistics: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Check(_Vertices):
    """What is found of an offset."""

    #: No face is inverted or collapsed, none crosses another anew, and none is on the wrong side.
    valid: bool
    #: (n,) distances that were asked for, or found.
    distances: np.ndarray
    #: With `face_errors=True`, (m,) of each face how far it is off its distance, as `Offset`'s; else None.
    face_errors: Optional[np.ndarray]
