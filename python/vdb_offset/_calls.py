# SPDX-License-Identifier: Apache-2.0
"""The functions of the package: keywords, and the results as objects. The compiled module does the work."""

from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core

Distance = Union[float, str, np.ndarray]
Faces = Union[np.ndarray, Tuple[np.ndarray, np.ndarray]]
Progress = Optional[Callable[[str, float], Any]]


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
        return 1.0 if used == 0 else float(counts[[_core.states.index(s) for s in ("reached", "mitred", "cut")]].sum() / used)


@dataclass(frozen=True, eq=False)
class Offset(_Vertices):
    """An offset: where each vertex of the input is."""

    #: (n, 3) positions, world units, in the order of the input's vertices.
    positions: np.ndarray
    #: (n,) distances that were asked for.
    distances: np.ndarray
    #: With `paths=True`, of each vertex the (k, 3) positions on its way; else None.
    paths: Optional[List[np.ndarray]]


@dataclass(frozen=True, eq=False)
class Refined(Offset):
    """An offset whose faces were split until they are proven to be at the distance. The vertices of the input come
    first, in their order, then the ones that were added; all arrays have a value for each of both."""

    #: (v, 3) positions in the source, which pair with `positions`.
    source: np.ndarray
    #: The faces, (m, k) or a pair of offsets and corners, and (m,) the input's faces that they are pieces of.
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
class Check(_Vertices):
    """What is found of an offset."""

    #: No face is inverted or collapsed, none crosses another anew, and none is on the wrong side.
    valid: bool
    #: (n,) distances that were asked for, or found.
    distances: np.ndarray


def _given(keywords: Dict[str, Any]) -> Dict[str, Any]:
    return {name: value for name, value in keywords.items() if value is not None}


def offset_several(
    vertices: np.ndarray,
    faces: Faces,
    distances: Sequence[Distance],
    *,
    distance_z: Optional[Union[float, str]] = None,
    corners: str = "round",
    miter_limit: float = 4,
    collision: str = "limit",
    only: Optional[np.ndarray] = None,
    border: str = "slide",
    symmetry: Union[bool, Sequence[Sequence[float]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None,
    clearance: float = 0,
    weld: Union[str, float] = "auto",
    orient: str = "keep",
    solver: str = "closest",
    precision: Union[str, int] = "double",
    voxel_size: Optional[float] = None,
    voxels_per_distance: Optional[float] = None,
    paths: bool = False,
    threads: int = 0,
    max_memory: Optional[int] = None,
    progress: Progress = None,
) -> List[Offset]:
    """Offsets a mesh by each of several distances, for little more than one.

    :param vertices: (n, 3) positions, world units
    :param faces: (m, k) numbers of vertices, or a pair of offsets and corners
    :param distances: see the module
    :param distance_z: the distance along z, beside a single one in the plane across it
    :param corners: "round": vertices at the distance; "miter": faces at the distance, beside sharp edges as well
    :param miter_limit: the longest miter, in distances, 1 or more
    :param collision: "limit": the result stays valid; "merge": each vertex goes as far as the distance grows
    :param only: (m,) booleans, or numbers of faces: those that are offset; the others stay, and are in the way
    :param border: what the edge of that part does: "slide", "fixed" or "free"
    :param symmetry: whether borders stay in the planes that they lie in; or planes (A, B, C, D), all x with
        A x + B y + C z = D, in which everything stays that lies there
    :param obstacles: vertices and faces of what is in the way
    :param clearance: the least distance from these, world units
    :param weld: "auto", "exact", "none", or the distance, world units, up to which vertices are one
    :param orient: "keep", or "fix-direction-only": outward is out of the solid that closed parts enclose
    :param solver: "closest", or "eikonal": the paper's
    :param precision: what will be kept of coordinates, on which validity is judged: "double", "single" or 1 to 17 digits
    :param voxel_size: of the grid, world units; or
    :param voxels_per_distance: how many voxels there are to a distance
    :param paths: whether the result has the vertices' ways
    :param threads: 0: as many as the machine has
    :param max_memory: bytes for the run, 0: no limit; None: 80 % of what is free
    :param progress: see the module
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:
    """
    keywords = _given({name: value for name, value in locals().items() if name in _OFFSET_KEYWORDS})
    return [Offset(**result) for result in _core.offset(vertices, faces, list(distances), keywords, progress)]


_OFFSET_KEYWORDS = frozenset(offset_several.__kwdefaults__) - {"progress"}


def offset(vertices: np.ndarray, faces: Faces, distance: Distance, **options: Any) -> Offset:
    """Offsets a mesh: its vertices and faces stay, and each vertex gets a position at the distance, or one as near to
    that as its state says.

    :param options: see `offset_several()`
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> offset(square, np.array([[0, 1, 2, 3]]), 0.25).positions[2].tolist()
    [1.0, 1.0, 0.25]
    >>> offset(square, np.array([[0, 1, 2, 9]]), 0.25)
    Traceback (most recent call last):
        ...
    vdb_offset.InvalidInput: faces: expected numbers of vertices, from 0 to 4 - 1, got another one as corner 3
    """
    return offset_several(vertices, faces, [distance], **options)[0]


def _options(function: str, options: Dict[str, Any], without: Sequence[str] = ()) -> Tuple[Dict[str, Any], Progress]:
    """Checks the names of keywords that are those of `offset_several()`, and takes `progress` out of them."""
    for name in options:
        if name not in offset_several.__kwdefaults__ or name in without:
            raise TypeError(f"{function}() got an unexpected keyword argument '{name}'")
    keywords = _given({name: value for name, value in options.items() if name != "progress"})
    return keywords, options.get("progress")


# What plane curves have no use for.
_NOT_OF_CURVES = ("only", "obstacles", "clearance", "symmetry", "border", "orient", "solver", "weld", "distance_z")


def offset_curves(points: np.ndarray, curves: Faces, distance: Distance, **options: Any) -> Offset:
    """Offsets plane curves within their plane, to the right of their direction: outward of one that runs ccw.

    :param points: (n, 3) positions in one plane, world units
    :param curves: (m, 2) segments, or a pair of offsets and points: each a polyline, closed if its last point is its first
    :param options: see `offset_several()`
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [80, 0, 0], [80, 80, 0], [0, 80, 0]], float)
    >>> kerf = offset_curves(square, (np.array([0, 5]), np.array([0, 1, 2, 3, 0])), 5, corners="miter")
    >>> np.ptp(kerf.positions, axis=0).round(9).tolist()
    [90.0, 90.0, 0.0]
    """
    keywords, progress = _options("offset_curves", options, _NOT_OF_CURVES)
    return Offset(**_core.offset_curves(points, curves, [distance], keywords, progress)[0])


def offset_to_tolerance(vertices: np.ndarray, faces: Faces, distance: Distance, tolerance: Union[float, str], *,
                        max_faces: int = 0, **options: Any) -> Refined:
    """Offsets a mesh, and splits its faces until they are proven to be at the distance, at every point of them.

    :param tolerance: how far off they may be: world units, or a text with a percentage of the distance
    :param max_faces: no more are made; 0: 20 times as many as the mesh has, at least a million
    :param options: see `offset_several()`
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> tent = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0.5]], float)
    >>> sides = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    >>> refined = offset_to_tolerance(tent, sides, 0.1, "1%")
    >>> len(refined.positions) > 5, refined.statistics["certified"]["certified"] > 0.999
    (True, True)
    """
    if max_faces < 0:
        raise _core.InvalidOption(f"max_faces: expected a whole number, 0 or more, got {max_faces!r}")
    keywords, progress = _options("offset_to_tolerance", options, ["paths", "distance_z"])
    return Refined(**_core.offset_to_tolerance(vertices, faces, distance, tolerance, max_faces, keywords, progress))


def fit(vertices: np.ndarray, faces: Faces, other: Tuple[np.ndarray, Faces], clearance: float, **options: Any) -> Offset:
    """Makes room between a mesh and another one: what is nearer to that than the clearance goes inward until it is not.

    :param other: vertices and faces
    :param clearance: world units, above 0
    :param options: see `offset_several()`
    :return: `distances` are those that were needed, and `statistics["fit"]` tells the gap that is left
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:
    """
    keywords, progress = _options("fit", options, ["paths", "obstacles", "clearance", "distance_z", "corners", "miter_limit", "collision"])
    return Offset(**_core.fit(vertices, faces, tuple(other), clearance, keywords, progress))


def shell(vertices: np.ndarray, faces: Faces, distance: Distance, **options: Any) -> Shell:
    """Makes a solid between the mesh and its offset.

    :param options: see `offset_several()`
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> solid = shell(square, np.array([[0, 1, 2, 3]]), 0.25)
    >>> len(solid.vertices), len(solid.faces), round(solid.statistics["shell"]["volume"], 9)
    (8, 6, 0.25)
    """
    keywords, progress = _options("shell", options, ["paths", "distance_z"])
    result = _core.shell(vertices, faces, distance, keywords, progress)
    return Shell(**{name: result[name] for name in Shell.__dataclass_fields__})


def _heights(evaluate: Callable[..., Any], given: Sequence[Any], heights: Any, count: Any, first: Any, total: Any,
             growth: float, keywords: Dict[str, Any]) -> List[Any]:
    """The heights of layers: those that are given, or `count` whose thickness grows by a factor."""
    if heights is not None:
        if count is not None or first is not None or total is not None:
            raise TypeError("expected heights, or a count with the first one or the total, got both")
        return list(heights)
    if count is None or (first is None) == (total is None):
        raise TypeError("expected heights, or a count with the first one or the total")
    if not (growth > 0 and np.isfinite(growth)):
        raise _core.InvalidOption(f"growth: expected a number above 0, got {growth!r}")
    base = evaluate(*given, first if first is not None else total, keywords)
    factors, step = [], 1.0
    for _ in range(count):
        factors.append((factors[-1] if factors else 0.0) + step)
        step *= growth
    return [base * (factor if first is not None else factor / factors[-1]) for factor in factors]


def layers(vertices: np.ndarray, faces: Faces, heights: Optional[Sequence[Distance]] = None, *,
           count: Optional[int] = None, first: Optional[Distance] = None, total: Optional[Distance] = None,
           growth: float = 1.2, **options: Any) -> Layers:
    """Grows layers of cells on a mesh, for a flow solver: prisms, hexahedra or polyhedra over its faces.

    :param heights: distances of the layers from the wall, rising, all to one side; or
    :param count: how many layers, with
    :param first: the height of the first one, or
    :param total: that of the last one, and
    :param growth: how many times as thick each layer is as the one before
    :param options: see `offset_several()`
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> grown = layers(square, np.array([[0, 1, 2, 3]]), count=3, first=0.1, growth=2)
    >>> grown.points[:, 2].reshape(4, 4)[:, 0].round(9).tolist(), grown.cell_types.tolist()
    ([0.0, 0.1, 0.3, 0.7], [12, 12, 12])
    """
    keywords, progress = _options("layers", options, ["paths", "collision", "distance_z"])
    wanted = _heights(_core.evaluate, (vertices, faces), heights, count, first, total, growth, keywords)
    return Layers(**_core.layers(vertices, faces, wanted, keywords, progress))


def curve_layers(points: np.ndarray, curves: Faces, heights: Optional[Sequence[Distance]] = None, *,
                 count: Optional[int] = None, first: Optional[Distance] = None, total: Optional[Distance] = None,
                 growth: float = 1.2, **options: Any) -> Layers:
    """Grows layers of quadrilaterals on plane curves; see `layers()` and `offset_curves()`."""
    keywords, progress = _options("curve_layers", options, ["paths", "collision", *_NOT_OF_CURVES])
    wanted = _heights(_core.evaluate_curves, (points, curves), heights, count, first, total, growth, keywords)
    return Layers(**_core.curve_layers(points, curves, wanted, keywords, progress))


def iso_surface(
    vertices: np.ndarray,
    faces: Faces,
    distance: Union[float, str],
    *,
    use_winding: bool = True,
    adaptivity: Optional[float] = None,
    keep_specks: bool = False,
    weld: Union[str, float] = "auto",
    orient: str = "keep",
    precision: Union[str, int] = "double",
    voxel_size: Optional[float] = None,
    voxels_per_distance: Optional[float] = None,
    threads: int = 0,
    max_memory: Optional[int] = None,
    progress: Progress = None,
) -> Iso:
    """Makes the surface at a distance from a mesh: a new mesh, closed and manifold, whatever the input is.

    :param distance: for all vertices, not 0
    :param use_winding: whether a mesh that is not closed can have an inside
    :param adaptivity: how readily voxels are merged, from 0 to 1; None: where it costs no accuracy
    :param keep_specks: whether pieces smaller than a voxel are kept
    :param voxel_size: the length of the new mesh's edges, world units

    The others are those of `offset_several()`.

    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:
    """
    names = set(iso_surface.__kwdefaults__) - {"progress"}
    keywords = _given({name: value for name, value in locals().items() if name in names})
    return Iso(**_core.iso_surface(vertices, faces, distance, keywords, progress))


_CHECK_KEYWORDS = ("distance_z", "corners", "miter_limit", "only", "border", "obstacles", "clearance", "weld", "orient",
                   "precision", "threads")


def _check_options(function: str, options: Dict[str, Any], without: Sequence[str] = ()) -> Dict[str, Any]:
    """All options of an offset may be given; those that a check has no use for do not count."""
    tolerance = options.pop("tolerance", None)
    keywords, _ = _options(function, options, without)
    return _given({**{name: keywords[name] for name in _CHECK_KEYWORDS if name in keywords}, "tolerance": tolerance})


def check(vertices: np.ndarray, faces: Faces, positions: np.ndarray, distance: Optional[Distance] = None,
          **options: Any) -> Check:
    """Measures positions as an offset of a mesh, wherever they come from: exact distances, and faults.

    :param positions: (n, 3), one for each vertex
    :param distance: the one that was asked for; None: the one that is found
    :param options: those that the offset was made with (see `offset_several()`), and `tolerance`: prove of as many faces
        as possible that they are that near to the distance at every point: world units, or a text with a percentage of it
    :raises InvalidInput, InvalidOption:
    """
    return Check(**_core.check(vertices, faces, positions, distance, _check_options("check", options)))


def check_curves(points: np.ndarray, curves: Faces, positions: np.ndarray, distance: Optional[Distance] = None,
                 **options: Any) -> Check:
    """Measures positions as an offset of plane curves; see `check()` and `offset_curves()`."""
    return Check(**_core.check_curves(points, curves, positions, distance, _check_options("check_curves", options, _NOT_OF_CURVES)))
