# SPDX-License-Identifier: Apache-2.0
"""Layers, as cells and as structured blocks, beside the command's."""
import numpy as np

import vdb_offset
from beside import CUBE, QUADS, BesideTheCommand, shape_of


#: SU2's numbers of cell types are VTK's, but for the order of a prism's corners.
WEDGE = 13


class Layers(BesideTheCommand):
    def read_cells(self, name):
        """Points and cells of an SU2 file, each cell its type and its corners."""
        with open(self.run_command.path(name), encoding="ascii") as file:
            lines = [line.split() for line in file]
        dimension = int(lines[0][1])
        first = {words[0]: i for i, words in enumerate(lines)}
        cells = [[int(w) for w in lines[first["NELEM="] + 1 + c][:-1]] for c in range(int(lines[first["NELEM="]][1]))]
        points = [[float(w) for w in lines[first["NPOIN="] + 1 + p][:dimension]] for p in range(int(lines[first["NPOIN="]][1]))]
        return np.array(points), cells

    def check_cells(self, grown, name):
        points, cells = self.read_cells(name)
        self.check_bits(grown.points[:, :points.shape[1]], points)
        at = 0
        for kind, (number, *corners) in zip(grown.cell_types, cells):
            mine = grown.cells[at + 1:at + 1 + grown.cells[at]]
            at += len(mine) + 1
            self.assertEqual(number, kind)
            self.assertEqual(corners, mine[[0, 2, 1, 3, 5, 4]].tolist() if kind == WEDGE else mine.tolist())
        self.assertEqual(len(cells), len(grown.cell_types))
        self.check_report(grown.statistics, self.run_command.report())

    def test_on_a_mesh(self):
        vertices, faces = shape_of("wedge", self.run_command)
        self.run_command("shape.obj", "made.su2", "--layers", "3", "--first-height", "2%", "--growth", "1.3", "--corners",
                         "miter", "--report", "report.json")
        self.check_cells(vdb_offset.layers(vertices, faces, count=3, first="2%", growth=1.3, corners="miter"), "made.su2")

    def write_with_groups(self, name, vertices, faces, groups):
        with open(self.run_command.path(name), "w", encoding="ascii") as out:
            out.writelines("v {!r} {!r} {!r}\n".format(*map(float, v)) for v in vertices)
            for face, group in zip(faces, groups):
                out.write(f"g {group}\nf " + " ".join(str(v + 1) for v in face) + "\n")

    def test_names_of_walls(self):
        run = self.run_command
        names = ["floor", "roof", "side 1", "side 1", "2nd", "outer"]
        self.write_with_groups("cube.obj", CUBE, QUADS, [name.replace(" ", "_") for name in names])
        with open(run.path("heights.txt"), "w", encoding="ascii") as out:
            out.write("0.1\n0.2\n")
        run("cube.obj", "made.su2", "--heights", "heights.txt", "--report", "report.json")
        for walls in (names, tuple(names), np.array(names), np.array(names, object)):
            grown = vdb_offset.layers(CUBE, QUADS, [0.1, 0.2], walls=walls)
            self.check_cells(grown, "made.su2")
        self.assertEqual(list(grown.patches), ["floor", "roof", "side_1", "wall_2nd", "outer_2", "outer"])
        self.assertEqual([len(grown.patches[name][0]) - 1 for name in grown.patches], [1, 1, 2, 1, 1, 6 + 12 * 2 + 8 * 6])
        with open(run.path("made.su2"), encoding="ascii") as file:
            self.assertEqual([line.split()[1] for line in file if line.startswith("MARKER_TAG")], list(grown.patches))
        self.assertEqual([patch["name"] for patch in grown.statistics["layers"]["patches"]], list(grown.patches)[:5])

    def test_fans(self):
        run = self.run_command
        run.write("cube.obj", CUBE, QUADS)
        run("cube.obj", "made.su2", "--layers", "2", "--total-thickness", "0.2", "--fan-angle", "30", "--report", "report.json")
        grown = vdb_offset.layers(CUBE, QUADS, count=2, total=0.2, fan_angle=30)
        self.check_cells(grown, "made.su2")
        self.assertGreater(grown.statistics["layers"]["fan_cells"], 0)
        self.assertEqual(len(grown.share), 8)
        square, ring = CUBE[:4], np.array([[0, 1, 3, 2, 0]])
        for angle, triangles in ((None, 8), (30, 12), (0, 0)):
            fans = vdb_offset.curve_layers(square, ring, [0.1, 0.2], fan_angle=angle)
            self.assertEqual(int((fans.cell_types == 5).sum()), triangles)
            self.assertEqual(len(fans.states), 4)
        with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'fan_angle'"):
            vdb_offset.structured_layers(CUBE, QUADS, [0.1], fan_angle=30)
        with self.assertRaisesRegex(vdb_offset.InvalidInput, "^fan angle: expected 0 or 5"):
            vdb_offset.layers(CUBE, QUADS, [0.1], fan_angle=3)

    def test_names_that_are_none(self):
        for wrong in (["a"] * 5, ["a"] * 7, "abcdef", ["a", "b", 3, "d", "e", "f"], 6, [b"a"] * 6, [None] * 6):
            with self.subTest(str(wrong)), self.assertRaisesRegex(vdb_offset.InvalidInput, "^walls: expected a name"):
                vdb_offset.layers(CUBE, QUADS, [0.1], walls=wrong)
        with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'walls'"):
            vdb_offset.curve_layers(CUBE[:2], np.array([[0, 1]]), [0.1], walls=["a"])

    def test_cells_for_openfoam(self):
        run = self.run_command
        # Quads that are bent: cells over them are valid sooner than OpenFOAM finds them to be.
        x, y = np.meshgrid(np.arange(8.0), np.arange(8.0))
        random = np.random.RandomState(1)  # pylint: disable=no-member
        vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1) + (random.random_sample((64, 3)) - 0.5) * [0.8, 0.8, 1.5]
        first = np.arange(64).reshape(8, 8)[:-1, :-1].ravel()
        faces = np.stack([first, first + 1, first + 9, first + 8], 1)
        run.write("shape.obj", vertices, faces)
        run("shape.obj", "polyMesh", "--layers", "2", "--total-thickness", "1", "--report", "report.json")
        with open(run.path("polyMesh/points"), encoding="ascii") as file:
            points = np.array([line.strip("()\n").split() for line in file if line.startswith("(") and len(line) > 2], float)
        grown = vdb_offset.layers(vertices, faces, count=2, total=1, cells="openfoam")
        self.check_bits(grown.points, points)
        # What is in OpenFOAM's terms is measured as its files are written.
        report = run.report()
        self.assertEqual(report["layers"].pop("openfoam")["wrong_faces"], 0)
        self.check_report(grown.statistics, report)
        plain = vdb_offset.layers(vertices, faces, count=2, total=1)
        self.assertFalse(plain.points.shape == grown.points.shape and (plain.points == grown.points).all())
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "cells: expected 'any' or 'openfoam'"):
            vdb_offset.layers(vertices, faces, [0.1], cells="OpenFOAM")

    def test_where_there_is_no_room(self):
        vertices, faces = shape_of("plates_open", self.run_command)
        self.run_command("shape.obj", "made.su2", "--layers", "3", "--total-thickness", "0.2", "--report", "report.json")
        grown = vdb_offset.layers(vertices, faces, count=3, total=0.2)
        self.check_cells(grown, "made.su2")
        self.assertLess(grown.share.min(), 1)

    def test_on_a_curve(self):
        points = np.array([[np.cos(t), np.sin(t), 0] for t in np.linspace(0, 2, 20)])
        with open(self.run_command.path("arc.txt"), "w", encoding="ascii") as out:
            out.writelines(f"{float(x)!r} {float(y)!r}\n" for x, y, _ in points)
        heights = [0.02, "3%", "0.1 + 0.1*x^2"]
        with open(self.run_command.path("heights.txt"), "w", encoding="ascii") as out:
            out.writelines(f"{height}\n" for height in heights)
        self.run_command("arc.txt", "made.su2", "--heights", "heights.txt", "--report", "report.json")
        grown = vdb_offset.curve_layers(points, (np.array([0, 20]), np.arange(20)), heights)
        self.check_cells(grown, "made.su2")


class Blocks(BesideTheCommand):
    def read_block(self, name):
        """Points of a Plot3D file, as the package has them."""
        with open(self.run_command.path(name), encoding="ascii") as file:
            words = file.read().split()
        ni, nj, nk = map(int, words[:3])
        return np.moveaxis(np.array(words[3:], float).reshape(3, nk, nj, ni), 0, -1)

    def test_block(self):
        run = self.run_command
        vertices, faces = shape_of("patch_wavy", run)
        run("shape.obj", "made.xyz", "--layers", "4", "--first-height", "0.01", "--growth", "1.5", "--structured", "--report",
            "report.json")
        block = vdb_offset.structured_layers(vertices, faces, count=4, first=0.01, growth=1.5)
        self.check_bits(block.points, self.read_block("made.xyz"))
        self.assertEqual(block.points.shape[0], 5)
        self.assertEqual(block.point_data["height"].shape, block.points.shape[:3])
        self.assertEqual(len(block.states), len(vertices))
        self.check_report(block.statistics, run.report())

    def test_block_on_a_curve(self):
        run = self.run_command
        points = np.array([[np.cos(t), np.sin(t), 0] for t in np.linspace(0, 2, 20)])
        with open(run.path("arc.txt"), "w", encoding="ascii") as out:
            out.writelines(f"{float(x)!r} {float(y)!r}\n" for x, y, _ in points)
        run("arc.txt", "made.xyz", "--layers", "3", "--total-thickness", "0.2", "--structured", "--report", "report.json")
        block = vdb_offset.structured_curve_layers(points, (np.array([0, 20]), np.arange(20)), count=3, total=0.2)
        self.check_bits(block.points, self.read_block("made.xyz"))
        self.assertEqual(block.points.shape, (1, 4, 20, 3))
        self.check_report(block.statistics, run.report())

    def test_no_block_but_of_a_grid(self):
        with self.assertRaises(vdb_offset.InvalidInput):
            vdb_offset.structured_layers(CUBE, QUADS, [0.1])
