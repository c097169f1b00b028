# SPDX-License-Identifier: Apache-2.0
"""Structured blocks of layers, beside the command's."""
import numpy as np

import vdb_offset
from beside import CUBE, QUADS, BesideTheCommand, shape_of


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
