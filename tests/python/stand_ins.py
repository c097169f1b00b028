# SPDX-License-Identifier: Apache-2.0
"""Small classes with what the package uses of other packages' meshes, for those that are not installed."""
import copy
import sys
import types

import numpy as np


class Trimesh:
    """As trimesh's: triangles, and attributes that a copy keeps."""

    def __init__(self, vertices, faces, process=True):
        self.vertices, self.faces, self.metadata = np.array(vertices, float), np.array(faces), {"name": "part"}

    @property
    def triangles(self):
        return self.vertices[self.faces]

    def copy(self):
        return copy.deepcopy(self)


class PolyData:
    """As PyVista's: points, and of each face the number of its corners and these."""

    def __init__(self, points, faces):
        self.points, self.faces, self.point_data = np.array(points, np.float32), np.array(faces), {}

    def copy(self):
        return copy.deepcopy(self)


class UnstructuredGrid:
    def __init__(self, cells, cell_types, points):
        self.cells, self.celltypes, self.points = np.array(cells), np.array(cell_types), np.array(points)
        self.n_cells = len(self.celltypes)


class Vector3dVector(list):
    """As Open3D's: rows of numbers that numpy reads."""

    def __init__(self, rows):
        super().__init__(np.asarray(rows, float))


class TriangleMesh:
    """As Open3D's, which has no copy()."""

    def __init__(self, vertices, triangles):
        self.vertices, self.triangles = Vector3dVector(vertices), [np.array(t) for t in triangles]


def install():
    """Puts modules in place of those that cannot be imported."""
    for name, classes in (("trimesh", [Trimesh]), ("pyvista", [PolyData, UnstructuredGrid])):
        try:
            __import__(name)
        except ImportError:
            module = types.ModuleType(name)
            for each in classes:
                setattr(module, each.__name__, each)
            sys.modules[name] = module
