# SPDX-License-Identifier: Apache-2.0
"""Lengths with units, beside the command's."""
import numpy as np

import vdb_offset
from beside import CUBE, QUADS, BesideTheCommand
from vdb_offset import _options

UNITS = ["um", "mm", "cm", "m", "in", "ft"]
NEAR = CUBE * [1, 1, 0.5] + [0, 0, 1.02]


class Lengths(BesideTheCommand):
    def setUp(self):
        super().setUp()
        self.run_command.write("cube.obj", CUBE, QUADS)
        self.run_command.write("near.obj", NEAR, QUADS)

    def test_numbers_are_those_of_the_command(self):
        random = np.random.RandomState(3)  # pylint: disable=no-member
        for unit in UNITS:
            # Of about the same size whatever the unit, and some round ones: those that suit the cube, all in one run.
            numbers = [random.random_sample() / _options.length("", f"10{each}", unit, float) for each in UNITS]
            texts = [f"{number!r}{each}" for number, each in zip(numbers, UNITS)]
            texts += [number + each for number in ("3 ", "+.7", "1.e-2") for each in UNITS]
            sizes = [_options.length("distance", text, unit) for text in texts]
            use = [(text, size) for text, size in zip(texts, sizes) if 1e-4 < float(size) < 0.2]
            self.assertGreater(len(use), 6)
            self.run_command("cube.obj", "made_{i}.obj", "--unit", unit, "--report", "report_{i}.json", "--precision", "17",
                             *(f"--distance={text}" for text, _ in use))
            several = vdb_offset.offset_several(CUBE, QUADS, [text for text, _ in use], unit=unit, precision=17)
            for i, ((text, size), result) in enumerate(zip(use, several)):
                report = self.run_command.report(f"report_{i + 1:03}.json")
                self.assertEqual(report["distance_as_given"], size, text)
                self.assertTrue((result.distances == float(size)).all())
                self.check_report(result.statistics, report)
                self.check_bits(result.positions, self.run_command.read(f"made_{i + 1:03}.obj")[0])

    def check_file(self, positions, *arguments):
        self.run_command("cube.obj", "made.obj", "--unit", "m", "--precision", "17", *arguments)
        self.check_bits(positions, self.run_command.read("made.obj")[0])

    def test_every_length_may_have_a_unit(self):
        box, options = (CUBE, QUADS), {"unit": "m", "precision": 17}
        self.check_file(vdb_offset.offset(*box, "73mm", voxel_size="4.1cm", weld="10 um", **options).positions,
                        "--distance=73mm", "--voxel-size=4.1cm", "--weld=10 um")
        self.check_file(vdb_offset.offset(*box, "20cm", obstacles=(NEAR, QUADS), clearance="9mm", **options).positions,
                        "--distance=20cm", "--obstacle=near.obj", "--clearance=9mm")
        self.check_file(vdb_offset.offset(*box, "0.3ft", distance_z="2in", **options).positions,
                        "--distance-xy=0.3ft", "--distance-z=2in")
        self.check_file(vdb_offset.fit(*box, (NEAR, QUADS), "5cm", **options).positions, "--fit=near.obj", "--clearance=5cm")
        self.check_file(vdb_offset.shell(*box, "10cm", inner="57mm", **options).vertices,
                        "--shell", "--distance=10cm", "--inner=57mm")
        self.check_file(vdb_offset.offset_to_tolerance(*box, "10cm", "7mm", **options).positions,
                        "--distance=10cm", "--tolerance=7mm")
        self.check_file(vdb_offset.iso_surface(*box, "10cm", voxel_size="90mm", **options).vertices,
                        "--mode=iso", "--distance=10cm", "--voxel-size=90mm")
        self.check_file(vdb_offset.iso_shell(*box, "1cm", inner="11cm", voxel_size="9cm", **options).vertices,
                        "--mode=iso", "--shell", "--distance=1cm", "--inner=11cm", "--voxel-size=9cm")
        for first in (True, False):
            self.run_command("cube.obj", "made.su2", "--unit=m", "--layers=2", "--report=report.json",
                             "--first-height=33mm" if first else "--total-thickness=33mm")
            grown = vdb_offset.layers(*box, count=2, unit="m", **{"first" if first else "total": "33mm"})
            self.check_report(grown.statistics, self.run_command.report())
        thick = vdb_offset.layers(*box, ["5cm", "0.1"], unit="m")
        self.assertTrue((thick.points == vdb_offset.layers(*box, [0.05, 0.1]).points).all())

    def test_lengths_of_checks_and_curves(self):
        moved = vdb_offset.offset(CUBE, QUADS, 0.1, corners="miter").positions
        self.run_command.write("moved.obj", moved, QUADS)
        self.run_command("check", "cube.obj", "moved.obj", "--unit=m", "--distance=10cm", "--tolerance=1mm", "--corners=miter",
                         "--report=report.json")
        found = vdb_offset.check(CUBE, QUADS, moved, "10cm", tolerance="1mm", unit="m", corners="miter")
        self.check_report(found.statistics, self.run_command.report(), ["source", "offset"])
        loop = (np.array([0, 5]), np.array([0, 1, 3, 2, 0]))
        kerf = vdb_offset.offset_curves(CUBE[:4], loop, "1in", unit="cm", voxel_size="0.8in")
        expected = vdb_offset.offset_curves(CUBE[:4], loop, 2.54, voxel_size=2.032)
        self.assertTrue((kerf.positions == expected.positions).all())
        [several] = vdb_offset.offset_curves_several(CUBE[:4], loop, ["1in"], unit="cm", voxel_size="0.8in")
        self.assertTrue((several.positions == expected.positions).all())
        check = vdb_offset.check_curves(CUBE[:4], loop, expected.positions, "1in", unit="cm")
        self.assertTrue((check.distances == 2.54).all())

    def test_what_has_no_unit_stays_as_it_is(self):
        expected = vdb_offset.offset(CUBE, QUADS, 0.1).positions
        for distance in (0.1, "0.1", "0.1 + 0*x", np.full(8, 0.1), np.float32(0.1) * 0 + np.float64(0.1)):
            self.assertTrue((vdb_offset.offset(CUBE, QUADS, distance, unit="in").positions == expected).all())
        self.assertTrue((vdb_offset.offset(CUBE, QUADS, "1%", unit="in").positions ==
                         vdb_offset.offset(CUBE, QUADS, "1%").positions).all())
        self.assertTrue((vdb_offset.offset(CUBE, QUADS, 0.1, voxel_size="0.05", weld="1e-5").positions ==
                         vdb_offset.offset(CUBE, QUADS, 0.1, voxel_size=0.05, weld=1e-5).positions).all())

    def test_a_unit_needs_the_one_of_the_arrays(self):
        box, near = (CUBE, QUADS), (NEAR, QUADS)
        calls = {"distance": lambda text: vdb_offset.offset(*box, text),
                 "distances": lambda text: vdb_offset.shell_several(*box, [0.1, text]),
                 "distance_z": lambda text: vdb_offset.iso_surface(*box, 0.1, distance_z=text),
                 "inner": lambda text: vdb_offset.iso_shell(*box, 0.1, inner=text),
                 "clearance": lambda text: vdb_offset.fit(*box, near, text),
                 "tolerance": lambda text: vdb_offset.check(*box, CUBE, 0.1, tolerance=text),
                 "voxel_size": lambda text: vdb_offset.iso_surface_several(*box, [0.1], voxel_size=text),
                 "weld": lambda text: vdb_offset.offset(*box, 0.1, weld=text),
                 "heights": lambda text: vdb_offset.structured_layers(*box, [text]),
                 "first": lambda text: vdb_offset.layers(*box, count=1, first=text),
                 "total": lambda text: vdb_offset.layers(*box, count=1, total=text),
                 "last": lambda text: vdb_offset.layers(*box, count=1, last=text)}
        self.assertEqual({name for name, option in _options.OPTIONS.items() if option.length} - set(calls), set())
        for name, call in calls.items():
            with self.subTest(name), self.assertRaisesRegex(vdb_offset.InvalidOption, f"^{name} '2mm' needs unit=, e.g. unit='mm'"):
                call("2mm")

    def test_units_that_mean_nothing(self):
        for wrong in ("parsec", "", "MM", 1, True, ["mm"]):
            with self.subTest(str(wrong)), self.assertRaisesRegex(vdb_offset.InvalidOption, "^unit: expected 'um', .* or 'ft', got"):
                vdb_offset.offset(CUBE, QUADS, 0.1, unit=wrong)
        for wrong in ("2km", "mm", "2mmm", "1e400mm", "inf", "nanmm", "0x1mm", "1_0mm", "2mm "):
            with self.subTest(wrong), self.assertRaises(ValueError):
                vdb_offset.offset(CUBE, QUADS, wrong, unit="mm")
        for wrong in ("2%", "2km", "two"):
            with self.assertRaisesRegex(vdb_offset.InvalidOption, "voxel_size: expected a number"):
                vdb_offset.offset(CUBE, QUADS, 0.1, voxel_size=wrong, unit="mm")
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "max_memory: expected"):
            vdb_offset.offset(CUBE, QUADS, 0.1, max_memory="4mm", unit="mm")
