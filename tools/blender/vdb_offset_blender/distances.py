# SPDX-License-Identifier: Apache-2.0
"""From an object in the scene to a call of vdb_offset, and back.

Distances are in units of the scene, and an object may be scaled. Scaled alike in all directions, its own coordinates
are offset by the distance divided by the scale, and what is judged are the very numbers that Blender stores. Scaled
otherwise, its coordinates in the scene are offset and brought back, which the last bits of Blender's numbers limit.
"""

import sys

import numpy as np

from . import arrays

INSTALL = (f"VDB Offset needs the package vdb_offset for Python {sys.version_info[0]}.{sys.version_info[1]}: "
           "install python3-vdb-offset, or a wheel")

# Matrices of Blender are of single precision.
_ALIKE = 1e-5


class Refused(Exception):
    """What cannot be done, in one line for whoever asked for it."""


def package():
    """The Python package, or None where it is not installed, or is another Python's."""
    try:
        import vdb_offset
    except ImportError:
        return None
    return vdb_offset


class Frame:
    """Where an object is offset: in its own coordinates, or in those of the scene."""

    def __init__(self, matrix):
        #: Rows; where the object stands makes no difference.
        self.rows = np.array(matrix, float)[:3, :3]
        if not np.isfinite(self.rows).all() or abs(np.linalg.det(self.rows)) <= 1e-12 * np.linalg.norm(self.rows) ** 3:
            raise Refused("The object's scale is 0 in a direction: apply or change it")
        squares = self.rows.T @ self.rows
        self.scale = np.sqrt(np.trace(squares) / 3)
        self.is_own = np.abs(squares - np.eye(3) * self.scale**2).max() <= _ALIKE * self.scale**2
        #: A mirrored object has its faces the other way round in the scene, and its outside where it was.
        self.is_mirrored = np.linalg.det(self.rows) < 0

    def mesh(self, positions, faces):
        if self.is_own:
            return positions.astype(float), faces
        return positions.astype(float) @ self.rows.T, arrays.turned(faces) if self.is_mirrored else faces

    def length(self, distance):
        return distance / self.scale if self.is_own else distance

    def back(self, positions):
        own = positions if self.is_own else np.linalg.solve(self.rows, positions.T).T
        return np.ascontiguousarray(own, np.float32)

    @property
    def precision(self):
        """In the scene's coordinates no number is stored."""
        return "single" if self.is_own else "double"


def offset(thing, distance, only=None, **options):
    """(n, 3) floats, the object's vertices moved, and the result of vdb_offset.

    :param distance: in units of the scene, a number or one for each vertex
    :param only: (m,) booleans, faces that are offset alone; None: all
    :raises Refused: with what vdb_offset says
    """
    library = package()
    if library is None:
        raise Refused(INSTALL)
    frame = Frame(thing.matrix_world)
    vertices, faces = frame.mesh(arrays.positions(thing.data), arrays.faces(thing.data))
    try:
        result = library.offset(vertices, faces, frame.length(distance), only=only, precision=frame.precision,
                                **options)
    except library.Error as error:
        raise Refused(str(error)) from None
    if result.reached == 0 and np.any(result.distances != 0):
        raise Refused("No vertex reached its distance: the mesh is thinner, or the distance has the wrong sign")
    return frame.back(result.positions), result


def summary_of(result):
    """One line about the result, and whether all vertices reached their distance."""
    count = result.statistics["vertices_by_state"]
    parts = [f"{len(result.states)} vertices: {100 * result.reached:.4g} % at their distance"]
    said = {"collision": "stopped by the other side", "limited": "held back to stay valid", "outside_field": "beyond the grid",
            "cut": "mitered and cut"}
    parts += [f"{count[state]} {words}" for state, words in said.items() if count.get(state)]
    error = (result.statistics.get("faces") or {}).get("mean_error")
    if error is not None:
        parts.append(f"faces {round(100 * error, 2):g} % off on average")
    return ", ".join(parts), result.reached == 1
