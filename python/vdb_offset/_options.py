# SPDX-License-Identifier: Apache-2.0
"""The keywords that functions share: the one list of their names, types, defaults and meanings. Signatures, what
`help()` says, the stubs, and what is refused are made of it."""

import inspect
import math
import os
import re
from typing import Any, Callable, Dict, List, Literal, NamedTuple, Optional, Sequence, Tuple, TypeVar, Union

import numpy as np

from . import _core

Distance = Union[float, str, np.ndarray]
Faces = Union[np.ndarray, Tuple[np.ndarray, np.ndarray]]
Progress = Optional[Union[Callable[[str, float], Any], str]]
Reserve = Optional[Callable[[int], Any]]
Function = TypeVar("Function", bound=Callable[..., Any])


class Option(NamedTuple):
    """A keyword of several functions."""

    type: Any
    default: Any
    text: str
    #: Of a length, which may have a unit: what it is handed on as, a text or a number.
    length: Optional[Callable[[str], Any]] = None


OPTIONS: Dict[str, Option] = {
    "inner": Option(Optional[Distance], None,
                    "how far inward the inner skin lies, not negative; None: on the mesh itself", str),
    "count": Option(Optional[int], None,
                    "instead of heights: how many layers, with two of the next; None: as many as `growth` allows, with\n"
                    "`first` and one of `total` and `last`"),
    "first": Option(Optional[Distance], None, "how thick the first layer is", str),
    "total": Option(Optional[Distance], None, "how thick all layers together are", str),
    "last": Option(Optional[Distance], None,
                   'how thick the outermost layer is; "edge": as the mean length of the edges around each vertex', str),
    "growth": Option(Optional[float], None,
                     "how many times as thick each layer is as the one before; None: as the others say, or 1.2"),
    "walls": Option(Optional[Sequence[str]], None,
                    "(m,) texts: the name of the patch of each face of the wall, which the result has in `patches`;\n"
                    'None: all are "wall"'),
    "cells": Option(Literal["any", "openfoam"], "any",
                    '"openfoam": valid as its checkMesh finds it, too, as in a polyMesh that the command writes'),
    "fan_angle": Option(Optional[float], None,
                        "edges that bend by more than so many degrees are opened into fans of cells, no two sides of\n"
                        'which are farther apart; 5 to 180; 0: none; None: 60, and 0 with corners="miter"'),
    "inside": Option(Literal["winding", "never"], "winding",
                     '"winding": a mesh that is closed but for small holes has an inside; "never": it is open'),
    "adaptivity": Option(Optional[float], None,
                         "how readily voxels are merged, from 0 to 1; None: where it costs no accuracy"),
    "keep_specks": Option(bool, False, "whether pieces smaller than a voxel are kept"),
    "distance_z": Option(Optional[Union[float, str]], None,
                         "the distance along z, if `distance` is a single one across it, of the same sign; one of\n"
                         "them may be 0, which counts as a thousandth of the other", str),
    "corners": Option(Optional[Literal["miter", "round", "arc"]], None,
                      '"miter": faces at the distance, at sharp edges as well; "round": vertices at the distance;\n'
                      '"arc", of offset_to_tolerance() and check() alone: faces are added over sharp edges;\n'
                      'None: "miter", and for layers "round"'),
    "miter_limit": Option(Optional[float], None,
                          'how far a vertex on a sharp edge may go, in distances, 1 or more; None: 4'),
    "collision": Option(Literal["limit", "merge"], "limit",
                        '"limit": the result stays valid; "merge": each vertex goes as far as the distance grows'),
    "taper": Option(float, 1.0,
                    "what falls short fades: from there, thickness rises by no more than so many times the way along\n"
                    "the surface; 0: it may rise at once"),
    "only": Option(Optional[np.ndarray], None,
                   "(m,) booleans, or numbers of faces: those that are offset; the others stay, as obstacles"),
    "border": Option(Literal["slide", "fixed", "free"], "slide",
                     "the edge of that part slides along what stays, is fixed, or moves freely"),
    "symmetry": Option(Union[bool, str, Sequence[Union[str, Sequence[float]]]], True,
                       'whether borders stay in the planes that they lie in (False or "none": they need not), or\n'
                       'planes in which everything stays that lies there: "x=0", "z=-1.5", "A,B,C,D" or\n'
                       "(A, B, C, D) for A x + B y + C z = D"),
    "obstacles": Option(Optional[Tuple[np.ndarray, Faces]], None, "vertices and faces of the obstacles"),
    "clearance": Option(Optional[Union[float, str]], None,
                        'with obstacles: the least distance from these, world units, or "1%" of the diagonal of the\n'
                        "mesh; None: 0", str),
    "close": Option(bool, False,
                    "whether to join ends of curves that nearly meet, closer than a tenth of the length"),
    "weld": Option(Union[Literal["auto", "exact", "none"], float, str], "auto",
                   'which vertices are welded: "exact": at equal positions; "auto": also at borders that differ\n'
                   'only by rounding; "none"; or a number: those no farther apart, world units', float),
    "orient": Option(Literal["keep", "fix-direction-only", "fix-cavities"], "keep",
                     'outward is where faces point; "fix-direction-only": it is out of what closed parts enclose; '
                     '"fix-cavities": also, closed parts in others are cavities'),
    "solver": Option(Literal["closest", "eikonal"], "closest",
                     'how the field is extended: "closest" (exact), or "eikonal" (first order, the paper\'s)'),
    "texture": Option(Optional[np.ndarray], None,
                      "what u and v are in a distance: (n, 2) numbers, one pair a vertex; or one a corner, (m, k, 2)\n"
                      "or (c, 2) for c corners in all: a vertex has those of its first corner"),
    "precision": Option(Union[Literal["double", "single"], int], "double",
                        "the precision of coordinates, for which validity is checked; a number: 1 to 17 digits"),
    "voxel_size": Option(Optional[Union[float, str]], None,
                         "of the grid, world units: the length of the edges of an iso-surface; or", float),
    "voxels_per_distance": Option(Optional[float], None, "the distance divided by the voxel size"),
    "unit": Option(Optional[Literal["um", "mm", "cm", "m", "in", "ft"]], None,
                   'the unit of the arrays; then lengths may be texts with a unit, as in "0.2mm"'),
    "paths": Option(bool, False, "whether the result has the paths of vertices"),
    "face_errors": Option(bool, False, "whether the result has how far each face is off its distance"),
    "save_vdb": Option(Optional[Union[str, os.PathLike]], None,
                       "a file to write: phi and the closest triangles as OpenVDB grids"),
    "threads": Option(int, 0, "0: as many as the machine has"),
    "max_memory": Option(Optional[Union[int, str]], None,
                         'for the run: bytes, or "4G"; 0: no limit; None: 80 % of what is free'),
    "reserve": Option(Reserve, None,
                      "called with the estimated peak of the memory, in bytes, before it is used; may wait until\n"
                      "there is room; False cancels (see the module)"),
    "progress": Option(Progress, None,
                       "called with the stage at hand and the share of the call that is done; False cancels (see the\n"
                       "module); \"tqdm\": a bar by that package"),
}

_HEIGHTS = ["count", "first", "total", "last", "growth"]
_OF_LAYERS = [*_HEIGHTS, "walls", "cells", "fan_angle"]
_OF_ISO = ["inside", "adaptivity", "keep_specks"]
_COMMON = ["precision", "voxel_size", "voxels_per_distance", "unit", "threads", "max_memory", "reserve", "progress"]
#: What functions of one kind take.
OFFSET = [name for name in OPTIONS if name not in ("inner", "close", *_OF_LAYERS, *_OF_ISO)]
CURVES = ["distance_z", "corners", "miter_limit", "collision", "close", "paths", "save_vdb", *_COMMON]
ISO = [*_OF_ISO, "weld", "orient", *_COMMON]
_NOT_OF_LAYERS = ("paths", "face_errors", "collision", "taper", "distance_z", "save_vdb")
LAYERS = [*_OF_LAYERS, *(name for name in OFFSET if name not in _NOT_OF_LAYERS)]
CURVE_LAYERS = [*_HEIGHTS, "fan_angle", *(name for name in CURVES if name not in _NOT_OF_LAYERS)]

#: Stands in docstrings for the options.
_PLACE = "    :param options: by keyword; `help()` describes each\n"


def takes(names: Sequence[str], without: Sequence[str] = ()) -> Callable[[Function], Function]:
    """Has a function with `**options` take some of the keywords: its signature and its documentation say so, and
    `given()` asks for no others."""

    def decorate(function: Function) -> Function:
        own = inspect.signature(function)
        parameters = [each for each in own.parameters.values() if each.kind is not inspect.Parameter.VAR_KEYWORD]
        lines = ""
        for name in (each for each in OPTIONS if each in names and each not in without):
            option = OPTIONS[name]
            parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=option.default,
                                                annotation=option.type))
            lines += f"    :param {name}: " + option.text.replace("\n", "\n        ") + "\n"
        if function.__doc__:  # python -OO leaves none
            function.__doc__ = function.__doc__.replace(_PLACE, lines)
        function.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
        function.__annotations__ = {**{each.name: each.annotation for each in parameters}, "return": own.return_annotation}
        return function

    return decorate


def given(function: Callable[..., Any], options: Dict[str, Any]) -> Tuple[Dict[str, Any], Progress]:
    """The options that a function was called with, `progress` apart from the others; None is as good as nothing.

    :raises TypeError: for a keyword that is not in the function's signature
    """
    names: List[str] = list(inspect.signature(function).parameters)
    for name in options:
        if name not in names:
            raise TypeError(f"{function.__name__}() got an unexpected keyword argument '{name}'")
    unit = options.get("unit")
    keywords = {name: length(name, value, unit, OPTIONS[name].length) for name, value in options.items()
                if value is not None and name not in ("progress", "unit")}
    progress = options.get("progress")
    if isinstance(progress, str):
        if progress != "tqdm":
            raise ValueError(f"progress: expected a function or 'tqdm', got '{progress}'")
        progress = bar(function.__name__)
    return keywords, progress


def bar(what: str) -> Callable[[str, float], None]:
    """A progress callback that draws a bar, with the time left.

    :raises ImportError: without the package tqdm
    """
    try:
        from tqdm.auto import tqdm
    except ImportError:
        raise ImportError("progress='tqdm' needs the package tqdm: pip install tqdm, or apt install python3-tqdm") from None
    drawn = tqdm(total=1, desc=what, bar_format="{desc}: {percentage:3.0f} %|{bar}| {elapsed}, {remaining} left{postfix}")

    def progress(stage: str, share: float) -> None:
        drawn.set_postfix_str(stage, refresh=False)
        drawn.update(share - drawn.n)
        if share == 1:
            drawn.close()

    return progress


def part(progress: Progress, number: int, count: int) -> Progress:
    """The callback for one of so many calls that are one to the user."""
    return progress and (lambda stage, share: progress(stage, (number + share) / count))


#: In micrometres, which are whole numbers: a quotient of two is the nearest one to what is meant, as the command has it.
_UNITS = {"um": 1.0, "mm": 1e3, "cm": 1e4, "m": 1e6, "in": 25400.0, "ft": 304800.0}
_LENGTH = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?) *(" + "|".join(_UNITS) + ")?")


def length(name: str, value: Any, unit: Optional[str], kind: Optional[Callable[[str], Any]] = str) -> Any:
    """A length without its unit, in units of the arrays; what has none stays as it is.

    :param name: of the keyword, for messages
    :param unit: of the arrays' numbers; None: it is not known
    :param kind: what it is returned as, `str` or `float`; None: the value is no length
    :raises InvalidOption: for a length with a unit where that of the arrays is not known, and for an unknown one
    """
    if unit is not None and not (isinstance(unit, str) and unit in _UNITS):
        *others, last = map(repr, _UNITS)
        raise _core.InvalidOption(f"unit: expected {', '.join(others)} or {last}, got {unit!r}")
    found = _LENGTH.fullmatch(value) if kind is not None and isinstance(value, str) else None
    if kind is None or found is None or not math.isfinite(float(found[1])):
        return value
    if found[2] is None:
        return kind(value)
    if unit is None:
        raise _core.InvalidOption(f"{name} {value!r} needs unit=, e.g. unit='mm' if the arrays' numbers are millimetres")
    if found[2] == unit:
        return kind(found[1])
    number = repr(float(found[1]) * _UNITS[found[2]] / _UNITS[unit])
    return kind(number[:-2] if number.endswith(".0") else number)  # in reports as the command's


def lengths(name: str, values: Sequence[Any], unit: Optional[str]) -> List[Any]:
    """Several lengths; see `length()`."""
    return [length(name, value, unit) for value in values]
