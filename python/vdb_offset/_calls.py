# SPDX-License-Identifier: Apache-2.0
"""The functions of the package: keywords, and the results as objects. The compiled module does the work.

What they take by keyword is listed in `_options`. `_calls.pyi` is made of the signatures by `python/stubs`."""

from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core, _options
from ._options import Distance, Faces, Progress, given, length, lengths, takes
from ._results import Block, Check, Iso, IsoShell, Layers, Offset, Refined, Shell


@takes(_options.OFFSET)
def offset_several(vertices: np.ndarray, faces: Faces, distances: Sequence[Distance], **options: Any) -> List[Offset]:
    """Offsets a mesh by each of several distances, for little more than one.

    :param vertices: (n, 3) positions, world units
    :param faces: (m, k) numbers of vertices, or a pair of offsets and corners
    :param distances: see the module
    :param options: by keyword; `help()` describes each
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:
    """
    wanted = lengths("distances", distances, options.get("unit"))
    results = _core.offset(vertices, faces, wanted, *given(offset_several, options))
    return [Offset(**result) for result in results]


@takes(_options.OFFSET)
def offset(vertices: np.ndarray, faces: Faces, distance: Distance, **options: Any) -> Offset:
    """Offsets a mesh: its vertices and faces stay, and each vertex gets a position at the distance, or one as near to
    that as its state says.

    :param vertices: (n, 3) positions, world units
    :param faces: (m, k) numbers of vertices, or a pair of offsets and corners
    :param distance: see the module
    :param options: by keyword; `help()` describes each
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> offset(square, np.array([[0, 1, 2, 3]]), 0.25).positions[2].tolist()
    [1.0, 1.0, 0.25]
    >>> offset(square, np.array([[0, 1, 2, 9]]), 0.25)
    Traceback (most recent call last):
        ...
    vdb_offset.InvalidInput: faces[0, 3] is 9; vertices are 0 to 3
    """
    wanted = [length("distance", distance, options.get("unit"))]
    return Offset(**_core.offset(vertices, faces, wanted, *given(offset, options))[0])


@takes(_options.CURVES)
def offset_curves_several(points: np.ndarray, curves: Faces, distances: Sequence[Distance],
                          **options: Any) -> List[Offset]:
    """Offsets plane curves by each of several distances; see `offset_curves()`.

    :param options: by keyword; `help()` describes each
    """
    wanted = lengths("distances", distances, options.get("unit"))
    results = _core.offset_curves(points, curves, wanted, *given(offset_curves_several, options))
    return [Offset(**result) for result in results]


@takes(_options.CURVES)
def offset_curves(points: np.ndarray, curves: Faces, distance: Distance, **options: Any) -> Offset:
    """Offsets plane curves within their plane, to the right of their direction: outward of one that runs ccw.

    :param points: (n, 3) positions in one plane, world units
    :param curves: (m, 2) segments, or a pair of offsets and points: each a polyline, closed if its last point is its first
    :param distance: see the module
    :param options: by keyword; `help()` describes each
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [80, 0, 0], [80, 80, 0], [0, 80, 0]], float)
    >>> kerf = offset_curves(square, (np.array([0, 5]), np.array([0, 1, 2, 3, 0])), 5, corners="miter")
    >>> np.ptp(kerf.positions, axis=0).round(9).tolist()
    [90.0, 90.0, 0.0]
    """
    wanted = [length("distance", distance, options.get("unit"))]
    return Offset(**_core.offset_curves(points, curves, wanted, *given(offset_curves, options))[0])


@takes(_options.OFFSET, without=["paths", "face_errors", "distance_z", "save_vdb"])
def offset_to_tolerance(vertices: np.ndarray, faces: Faces, distance: Distance, tolerance: Union[float, str], *,
                        max_faces: int = 0, ridges_only: bool = False, **options: Any) -> Refined:
    """Offsets a mesh, and splits its faces until they are proven to be at the distance, at every point of them.

    :param tolerance: how far off they may be: world units, or a text with a percentage of the distance
    :param max_faces: no more are made; 0: 20 times as many as the mesh has, at least a million
    :param ridges_only: with corners="arc", add faces over sharp edges, and split none
    :param options: by keyword; `help()` describes each
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> tent = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0.5]], float)
    >>> sides = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    >>> refined = offset_to_tolerance(tent, sides, 0.1, "1%", corners="round")
    >>> len(refined.positions) > 5, refined.statistics["certified"]["certified"] > 0.999
    (True, True)
    """
    if max_faces < 0:
        raise _core.InvalidOption(f"max_faces: expected a whole number, 0 or more, got {max_faces!r}")
    keywords, unit = given(offset_to_tolerance, options), options.get("unit")
    wanted, within = length("distance", distance, unit), length("tolerance", tolerance, unit)
    return Refined(**_core.offset_to_tolerance(vertices, faces, wanted, within, max_faces, bool(ridges_only), *keywords))


@takes(_options.OFFSET, without=["obstacles", "clearance", "distance_z", "corners", "miter_limit", "collision",
                                 "taper", "texture", "save_vdb"])
def fit(vertices: np.ndarray, faces: Faces, other: Tuple[np.ndarray, Faces], clearance: Union[float, str],
        **options: Any) -> Offset:
    """Makes room between a mesh and another one: what is nearer to that than the clearance goes inward until it is not.

    :param other: vertices and faces
    :param clearance: above 0: world units, or "1%" of the diagonal of the mesh
    :param options: by keyword; `help()` describes each
    :return: `distances` are those that were needed, and `statistics["fit"]` has the gap that is left
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:
    """
    room = length("clearance", clearance, options.get("unit"))
    return Offset(**_core.fit(vertices, faces, tuple(other), room, *given(fit, options)))


_OF_SHELLS = ["inner", *_options.OFFSET]
_NOT_OF_SHELLS = ["distance_z"]


def _shells(vertices: np.ndarray, faces: Faces, distances: List[Distance],
            asked: Tuple[Dict[str, Any], Progress]) -> List[Shell]:
    keywords, progress = asked
    results = _core.shell(vertices, faces, distances, keywords.pop("inner", None), keywords, progress)
    return [Shell(**{name: result[name] for name in Shell.__dataclass_fields__}) for result in results]


@takes(_OF_SHELLS, without=_NOT_OF_SHELLS)
def shell_several(vertices: np.ndarray, faces: Faces, distances: Sequence[Distance], **options: Any) -> List[Shell]:
    """Makes a solid between the mesh, or one inner skin, and each of several offsets; see `shell()`.

    :param options: by keyword; `help()` describes each
    """
    return _shells(vertices, faces, lengths("distances", distances, options.get("unit")), given(shell_several, options))


@takes(_OF_SHELLS, without=_NOT_OF_SHELLS)
def shell(vertices: np.ndarray, faces: Faces, distance: Distance, **options: Any) -> Shell:
    """Makes a solid between the mesh and its offset, or with `inner` between two offsets.

    :param options: by keyword; `help()` describes each
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> solid = shell(square, np.array([[0, 1, 2, 3]]), 0.25)
    >>> len(solid.vertices), len(solid.faces), round(solid.statistics["shell"]["volume"], 9)
    (8, 6, 0.25)
    >>> np.ptp(shell(square, np.array([[0, 1, 2, 3]]), 0.25, inner=0.125).vertices[:, 2])
    0.375
    """
    return _shells(vertices, faces, [length("distance", distance, options.get("unit"))], given(shell, options))[0]


# What the command takes at most.
_MOST_LAYERS, _MOST_GROWTH = 1000, 10


def _heights(plan: Callable[..., List[Any]], arrays: Sequence[Any], heights: Any, keywords: Dict[str, Any],
             unit: Optional[str]) -> List[Any]:
    """The heights of layers: those that are given, or as planned. Takes the keywords that say so out of the others."""
    known = {name: keywords.pop(name, None) for name in ("count", "growth", "first", "total", "last")}
    count, growth = known["count"], known["growth"]
    thicknesses = sum(known[name] is not None for name in ("first", "total", "last"))
    if heights is not None:
        for name in ("first", "total", "last", "growth"):
            if known[name] is not None:
                raise _core.InvalidOption(f"{name} and heights exclude each other")
        each = lengths("heights", heights, unit)
        if count is not None and count != len(each):
            raise _core.InvalidOption(f"count: expected {len(each)}, as many as there are heights, got {count!r}")
        return each
    if count is None and (thicknesses != 2 or known["first"] is None):
        raise _core.InvalidOption("expected heights, or a count with one of first, total and last, or first with one of "
                                  "the others")
    if count is not None and not (thicknesses == 1 or (thicknesses == 2 and growth is None)):
        raise _core.InvalidOption("expected a count with two of first, total, last and growth, or one of first, total "
                                  "and last")
    if count is not None and (not (isinstance(count, (int, np.integer)) and 1 <= count <= _MOST_LAYERS)
                              or isinstance(count, bool)):
        raise _core.InvalidOption(f"count: expected a whole number, 1 to {_MOST_LAYERS}, got {count!r}")
    if growth is None and (count is None or thicknesses == 1):
        growth = known["growth"] = 1.2
    if growth is not None and not (isinstance(growth, (int, float, np.number)) and 0 < growth <= _MOST_GROWTH):
        raise _core.InvalidOption(f"growth: expected a number above 0, up to {_MOST_GROWTH}, got {growth!r}")
    return plan(*arrays, known, keywords)


def height_of_y_plus(y_plus: float, reynolds: float, length: float = 1.0) -> float:
    """The height over a wall at which y+ has a value, for `first`, by the law for a flat plate: length y+ / (Re sqrt(c_f
    / 2)), with the larger c_f of Schlichting's (2 log10 Re - 0.65)^-2.3 and Blasius' 0.664 / sqrt(Re).

    :param reynolds: that of the length
    :raises InvalidInput: for numbers that are not above 0

    >>> height_of_y_plus(1, 1e6)
    2.31079e-05
    """
    return _core.height_of_y_plus(y_plus, reynolds) * length


@takes(_options.LAYERS)
def layers(vertices: np.ndarray, faces: Faces, heights: Optional[Sequence[Distance]] = None, **options: Any) -> Layers:
    """Grows layers of cells on a mesh, for a flow solver: prisms, hexahedra or polyhedra over its faces.

    :param heights: distances of the layers from the wall, rising, all to one side
    :param options: by keyword; `help()` describes each
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> grown = layers(square, np.array([[0, 1, 2, 3]]), count=3, first=0.1, growth=2)
    >>> grown.points[:, 2].reshape(4, 4)[:, 0].round(9).tolist(), grown.cell_types.tolist()
    ([0.0, 0.1, 0.3, 0.7], [12, 12, 12])
    """
    keywords, progress = given(layers, options)
    wanted = _heights(_core.plan, (vertices, faces), heights, keywords, options.get("unit"))
    return Layers(**_core.layers(vertices, faces, wanted, keywords, progress))


@takes(_options.CURVE_LAYERS)
def curve_layers(points: np.ndarray, curves: Faces, heights: Optional[Sequence[Distance]] = None,
                 **options: Any) -> Layers:
    """Grows layers of quadrilaterals on plane curves; see `layers()` and `offset_curves()`.

    :param options: by keyword; `help()` describes each
    """
    keywords, progress = given(curve_layers, options)
    wanted = _heights(_core.plan_curves, (points, curves), heights, keywords, options.get("unit"))
    return Layers(**_core.curve_layers(points, curves, wanted, keywords, progress))


@takes(_options.ISO + ["distance_z"])
def iso_surface(vertices: np.ndarray, faces: Faces, distance: Union[float, str], **options: Any) -> Iso:
    """Makes the surface at a distance from a mesh: a new mesh, closed and manifold, whatever the input is.

    :param distance: for all vertices, not 0
    :param options: by keyword; `help()` describes each
    :raises InvalidResult: if the surface is not valid; `statistics` of the exception are its report
    :raises InvalidInput, InvalidOption, OutOfBudget, Cancelled:

    >>> import numpy as np
    >>> triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    >>> iso_surface(triangle, np.array([[0, 1, 2]]), 0.25, voxel_size=0.1).statistics["surface"]["closed"]
    True
    """
    wanted = length("distance", distance, options.get("unit"))
    return Iso(**_core.iso_surface(vertices, faces, wanted, *given(iso_surface, options)))


@takes(_options.ISO + ["distance_z"])
def iso_surface_several(vertices: np.ndarray, faces: Faces, distances: Sequence[Union[float, str]],
                        **options: Any) -> List[Iso]:
    """Makes the surface at each of several distances, one after the other; see `iso_surface()`.

    :param options: by keyword; `help()` describes each
    """
    keywords, progress = given(iso_surface_several, options)
    wanted = lengths("distances", distances, options.get("unit"))
    return [Iso(**_core.iso_surface(vertices, faces, distance, keywords, _options.part(progress, i, len(wanted))))
            for i, distance in enumerate(wanted)]


@takes(_options.ISO + ["inner"])
def iso_shell(vertices: np.ndarray, faces: Faces, distance: Union[float, str], **options: Any) -> IsoShell:
    """Makes a hollow solid of the mesh and its iso-surface, which is its cavity if the distance is negative, or with
    `inner` of two iso-surfaces.

    :param distance: for all vertices, not 0
    :param options: by keyword; `help()` describes each
    :raises InvalidInput: for a mesh that has no inside, too
    :raises InvalidResult: as `iso_surface()`
    :raises InvalidOption, OutOfBudget, Cancelled:
    """
    keywords, progress = given(iso_shell, options)
    wanted = length("distance", distance, options.get("unit"))
    return IsoShell(**_core.iso_shell(vertices, faces, wanted, keywords.pop("inner", None), keywords, progress))


@takes(_options.LAYERS, without=["cells", "fan_angle"])
def structured_layers(vertices: np.ndarray, faces: Faces, heights: Optional[Sequence[Distance]] = None,
                      **options: Any) -> Block:
    """Grows layers on a mesh that is a grid of quads, as a structured block of hexahedra; see `layers()`.

    :param options: by keyword; `help()` describes each

    >>> import numpy as np
    >>> square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> structured_layers(square, np.array([[0, 1, 2, 3]]), [0.1, 0.3]).points[:, 0, 0].round(9).tolist()
    [[0.0, 0.0, 0.0], [0.0, 0.0, 0.1], [0.0, 0.0, 0.3]]
    """
    keywords, progress = given(structured_layers, options)
    wanted = _heights(_core.plan, (vertices, faces), heights, keywords, options.get("unit"))
    return Block(**_core.structured_layers(vertices, faces, wanted, keywords, progress))


@takes(_options.CURVE_LAYERS, without=["fan_angle"])
def structured_curve_layers(points: np.ndarray, curves: Faces, heights: Optional[Sequence[Distance]] = None,
                            **options: Any) -> Block:
    """Grows layers on one plane curve, as a structured block of quadrilaterals; see `curve_layers()`.

    :param options: by keyword; `help()` describes each
    """
    keywords, progress = given(structured_curve_layers, options)
    wanted = _heights(_core.plan_curves, (points, curves), heights, keywords, options.get("unit"))
    return Block(**_core.structured_curve_layers(points, curves, wanted, keywords, progress))


@takes(_options.OFFSET, without=["reserve"])
def check(vertices: np.ndarray, faces: Faces, positions: np.ndarray, distance: Optional[Distance] = None, *,
          tolerance: Optional[Union[float, str]] = None, **options: Any) -> Check:
    """Measures positions as an offset of a mesh, wherever they come from: exact distances, and faults.

    The keywords are those that the offset was made with; those about how it was made have no effect here.

    :param positions: (n, 3), one for each vertex
    :param distance: the one that was asked for; None: the one that is found
    :param tolerance: prove of as many faces as possible that they are that near to the distance at every point: world
        units, or a text with a percentage of it
    :param options: by keyword; `help()` describes each
    :raises InvalidInput, InvalidOption, Cancelled:
    """
    keywords, unit = given(check, options), options.get("unit")
    wanted, within = length("distance", distance, unit), length("tolerance", tolerance, unit)
    return Check(**_core.check(vertices, faces, positions, wanted, within, *keywords))


@takes(_options.CURVES, without=["distance_z", "reserve"])
def check_curves(points: np.ndarray, curves: Faces, positions: np.ndarray, distance: Optional[Distance] = None,
                 **options: Any) -> Check:
    """Measures positions as an offset of plane curves; see `check()` and `offset_curves()`.

    :param options: by keyword; `help()` describes each
    """
    wanted = length("distance", distance, options.get("unit"))
    return Check(**_core.check_curves(points, curves, positions, wanted, None, *given(check_curves, options)))
