# SPDX-License-Identifier: Apache-2.0
"""Offsets of plane curves, beside the command's."""
import numpy as np

import vdb_offset
from beside import BesideTheCommand


L_SHAPE = np.array([[0, 0, 0], [8, 0, 0], [8, 5, 0], [3, 5, 0], [3, 8, 0], [0, 8, 0]], float)
CLOSED = (np.array([0, 7]), np.array([0, 1, 2, 3, 4, 5, 0]))
#: A wedge, open at its blunt base.
WEDGE = np.array([[4, 0.1, 0], [2, 0.3, 0], [0, 0, 0], [2, -0.3, 0], [4, -0.1, 0]], float)
OPEN = (np.array([0, 5]), np.arange(5))


class Curves(BesideTheCommand):
    def write_curve(self, name, points):
        with open(self.run_command.path(name), "w", encoding="ascii") as out:
            out.writelines(f"{x} {y}\n" for x, y, _ in points)

    def read_curve(self, name):
        with open(self.run_command.path(name), encoding="ascii") as lines:
            return np.array([[float(w) for w in line.split()] for line in lines if line.strip()])

    def check(self, points, curves, distance, arguments, **options):
        run = self.run_command
        self.write_curve("curve.txt", points[curves[1]])
        run("curve.txt", "made.txt", *arguments)
        result = vdb_offset.offset_curves(points, curves, distance, **options)
        made = self.read_curve("made.txt")
        self.check_bits(result.positions[:, :2], made[:len(points)])
        self.assertFalse((made == points[curves[1], :2]).all())
        return result

    def test_closed(self):
        result = self.check(L_SHAPE, CLOSED, -0.4, ["--distance=-0.4", "--precision", "17"], precision=17)
        self.assertTrue(vdb_offset.check_curves(L_SHAPE, CLOSED, result.positions, -0.4).valid)

    def test_statistics(self):
        run = self.run_command
        self.write_curve("curve.txt", WEDGE)
        run("curve.txt", "made.txt", "--distance=0.05", "--report", "report.json")
        self.check_report(vdb_offset.offset_curves(WEDGE, OPEN, 0.05).statistics, run.report())

    def test_several_distances(self):
        self.write_curve("curve.txt", L_SHAPE[CLOSED[1]])
        self.run_command("curve.txt", "made_{i}.txt", "--distance=0.4", "--distance=-3%", "--corners", "miter")
        several = vdb_offset.offset_curves_several(L_SHAPE, CLOSED, [0.4, "-3%"], corners="miter")
        self.assertEqual(len(several), 2)
        for i, result in enumerate(several):
            self.check_bits(result.positions[:, :2], self.read_curve(f"made_00{i + 1}.txt")[:6])

    def test_distances_by_axis(self):
        # In a plane that z lies in: 0.2 along x, 0.4 along z.
        upright = L_SHAPE[:, [0, 2, 1]]
        run = self.run_command
        with open(run.path("curve.txt"), "w", encoding="ascii") as out:
            out.writelines(f"{x} {y} {z}\n" for x, y, z in upright[CLOSED[1]])
        run("curve.txt", "made.txt", "--distance-xy=0.2", "--distance-z=0.4")
        result = vdb_offset.offset_curves(upright, CLOSED, 0.2, distance_z=0.4)
        self.check_bits(result.positions, self.read_curve("made.txt")[:6])
        self.assertFalse((result.positions == vdb_offset.offset_curves(upright, CLOSED, 0.2).positions).all())
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "exclude each other"):
            vdb_offset.offset_curves(upright, CLOSED, 0.2, distance_z=0.4, precision=6)
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "distance_z"):
            vdb_offset.offset_curves_several(upright, CLOSED, [0.2, 0.3], distance_z=0.4)

    def test_close(self):
        closed = self.check(WEDGE, OPEN, 0.1, ["--distance=0.1", "--close"], close=True)
        self.assertGreater(closed.positions[0, 0], 4.05)
        self.assertEqual(vdb_offset.offset_curves(WEDGE, OPEN, 0.1).positions[0, 0] > 4.05, False)
        check = vdb_offset.check_curves(WEDGE, OPEN, closed.positions, 0.1, close=True)
        self.assertTrue(check.valid)
        self.assertTrue((check.states == closed.states).all())

    def test_close_what_is_not_nearly_closed(self):
        with self.assertRaisesRegex(vdb_offset.InvalidInput, "close: expected a closed curve, or ends nearer"):
            vdb_offset.offset_curves(L_SHAPE, (np.array([0, 4]), np.arange(4)), 0.1, close=True)
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "close: expected True or False"):
            vdb_offset.offset_curves(WEDGE, OPEN, 0.1, close="yes")
        # There is nothing to close.
        same = vdb_offset.offset_curves(L_SHAPE, CLOSED, 0.1, close=True)
        self.assertTrue((same.positions == vdb_offset.offset_curves(L_SHAPE, CLOSED, 0.1).positions).all())

    def test_layers_of_a_closed_curve(self):
        grown = vdb_offset.curve_layers(WEDGE, OPEN, [0.05, 0.1], close=True)
        self.assertEqual(set(grown.patches), {"wall", "outer"})
        self.assertEqual(set(vdb_offset.curve_layers(WEDGE, OPEN, [0.05, 0.1]).patches), {"wall", "outer", "sides"})

    def test_field_is_saved(self):
        path = self.run_command.path("field.vdb")
        vdb_offset.offset_curves_several(L_SHAPE, CLOSED, [0.1, -0.1], save_vdb=path)
        with open(path, "rb") as field:
            self.assertIn(b"closest", field.read())

    def test_what_curves_do_not_have(self):
        for option in ("only", "texture", "weld", "border"):
            with self.assertRaisesRegex(TypeError, f"unexpected keyword argument '{option}'"):
                vdb_offset.offset_curves(WEDGE, OPEN, 0.1, **{option: None})
        with self.assertRaisesRegex(vdb_offset.InvalidInput, "curves have no texture"):
            vdb_offset.offset_curves(WEDGE, OPEN, "u")
