# SPDX-License-Identifier: Apache-2.0
"""Shells, iso-surfaces and hollow solids, beside the command's."""
import numpy as np

import vdb_offset
from beside import CUBE, QUADS, BesideTheCommand, shape_of


class Solids(BesideTheCommand):
    def check_shell(self, scene, distances, arguments=(), **options):
        run = self.run_command
        vertices, faces = shape_of(scene, run)
        run("shape.obj", "made_{i}.obj", "--shell", *(f"--distance={d}" for d in distances), "--precision", "17", "--report",
            "report_{i}.json", *arguments)
        solids = vdb_offset.shell_several(vertices, faces, distances, precision=17, **options)
        self.assertEqual(len(solids), len(distances))
        for i, solid in enumerate(solids):
            made, made_faces = run.read(f"made_00{i + 1}.obj")
            self.check_bits(solid.vertices, made)
            self.check_faces(solid.faces, made_faces)
            self.check_report(solid.statistics, run.report(f"report_00{i + 1}.json"))
        if len(distances) == 1:
            alone = vdb_offset.shell(vertices, faces, distances[0], precision=17, **options)
            self.check_bits(alone.vertices, solids[0].vertices)
        return solids

    def test_shell(self):
        [solid] = self.check_shell("patch_wavy", [0.1])
        self.assertEqual(set(solid.parts), {0, 1, 2})
        self.assertEqual(len(solid.source_faces), len(solid.parts))

    def test_shells_at_several_distances(self):
        self.check_shell("patch_wavy", [0.05, "3%", -0.1])

    def test_inner_skin(self):
        self.check_shell("gear", ["0.5%"], ["--inner", "0.01"], inner=0.01)
        self.check_shell("torus", ["0.5%"], ["--inner", "0.5%", "--corners", "miter"], inner="0.5%", corners="miter")
        self.check_shell("patch_wavy", [0], ["--inner", "0.02 + 0.01*nz"], inner="0.02 + 0.01*nz")

    def test_several_shells_over_one_inner_skin(self):
        self.check_shell("patch_wavy", [0.05, 0.1], ["--inner", "2%"], inner="2%")

    def test_inner_skin_by_an_array(self):
        square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
        solid = vdb_offset.shell(square, np.array([[0, 1, 2, 3]]), 0.25, inner=[0.1, 0.1, 0.2, 0.2])
        np.testing.assert_allclose(solid.vertices[:, 2], [0.25] * 4 + [-0.1, -0.1, -0.2, -0.2], atol=1e-9)

    def test_inner_skins_that_cannot_be(self):
        for distance, inner, text in ((0.1, -0.1, "inner: expected"), (0.1, 0, "inner: expected"), (-0.1, 0.1, "distance: expected"),
                                      (0.1, "x - 0.5", "inner: expected"), (0.1, "some", "some"), (0.1, [0.1], "inner: expected")):
            with self.subTest(str(inner)), self.assertRaisesRegex(ValueError, text):
                vdb_offset.shell(CUBE, QUADS, distance, inner=inner)
        with self.assertRaises(vdb_offset.InvalidOption):
            vdb_offset.shell_several(CUBE, QUADS, [], inner=0.1)
        with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'inner'"):
            vdb_offset.offset(CUBE, QUADS, 0.1, inner=0.1)

    def test_field_of_a_shell_is_saved(self):
        path = self.run_command.path("field.vdb")
        vdb_offset.shell(CUBE, QUADS, 0.1, inner=0.1, save_vdb=path)
        with open(path, "rb") as field:
            self.assertIn(b"closest", field.read())

    def check_iso(self, arguments, make):
        run = self.run_command
        run.write("cube.obj", CUBE, QUADS)
        run("cube.obj", "made.obj", "--mode", "iso", "--voxel-size", "0.1", "--precision", "17", "--report", "report.json",
            *arguments)
        iso = make(CUBE, QUADS, voxel_size=0.1, precision=17)
        made, made_faces = run.read("made.obj")
        self.check_bits(iso.vertices, made)
        self.check_faces(iso.faces, made_faces)
        self.check_report(iso.statistics, run.report(), ["distance_as_given"])
        self.assertTrue(iso.statistics["surface"]["valid"])
        return iso

    def test_iso_surface(self):
        self.check_iso(["--distance=0.1"], lambda *mesh, **options: vdb_offset.iso_surface(*mesh, 0.1, **options))

    def test_iso_surface_by_axis(self):
        iso = self.check_iso(["--distance-xy=0.1", "--distance-z=0.2"],
                             lambda *mesh, **options: vdb_offset.iso_surface(*mesh, 0.1, distance_z=0.2, **options))
        np.testing.assert_allclose(np.ptp(iso.vertices, axis=0), [1.2, 1.2, 1.4], atol=1e-6)

    def test_iso_surfaces_at_several_distances(self):
        run = self.run_command
        run.write("cube.obj", CUBE, QUADS)
        run("cube.obj", "made_{i}.obj", "--mode", "iso", "--distance=0.1", "--distance=-10%", "--precision", "17",
            "--voxel-size=0.1")
        several = vdb_offset.iso_surface_several(CUBE, QUADS, [0.1, "-10%"], precision=17, voxel_size=0.1)
        for i, iso in enumerate(several):
            self.check_bits(iso.vertices, run.read(f"made_00{i + 1}.obj")[0])
        self.assertEqual(i, 1)

    def test_iso_surface_by_axis_of_which_one_is_0(self):
        run = self.run_command
        plate = CUBE * [1, 1, 0.01]
        run.write("plate.obj", plate, QUADS)
        run("plate.obj", "made.obj", "--mode", "iso", "--distance-xy=0.2", "--distance-z=0", "--precision", "17",
            "--voxel-size=0.2")
        iso = vdb_offset.iso_surface(plate, QUADS, 0.2, distance_z=0, precision=17, voxel_size=0.2)
        self.check_bits(iso.vertices, run.read("made.obj")[0])
        self.assertLess(np.ptp(iso.vertices[:, 2]), 0.0105)

    def test_what_is_inside(self):
        run = self.run_command
        vertices, faces = shape_of("torus", run)
        holed = faces[1:]  # one face in many is missing
        run.write("holed.obj", vertices, holed)
        sizes = []
        for inside in ("winding", "never"):
            run("holed.obj", "made.obj", "--mode", "iso", "--distance=5%", "--inside", inside, "--precision", "17",
                "--voxel-size=0.1")
            iso = vdb_offset.iso_surface(vertices, holed, "5%", inside=inside, precision=17, voxel_size=0.1)
            self.check_bits(iso.vertices, run.read("made.obj")[0])
            sizes.append(len(iso.vertices))
        self.assertLess(sizes[0], sizes[1])
        for wrong in ("always", True, ""):
            with self.assertRaisesRegex(vdb_offset.InvalidOption, "inside: expected 'winding' or 'never'"):
                vdb_offset.iso_surface(vertices, holed, "5%", inside=wrong)

    def test_no_surface_that_is_not_valid(self):
        soup, faces = np.random.RandomState(2).random_sample((36, 3)), np.arange(36).reshape(12, 3)  # pylint: disable=no-member
        run = self.run_command
        run.write("soup.obj", soup, faces)
        done = run("soup.obj", "made.obj", "--mode", "iso", "--distance=0.03", "--adaptivity", "1", "--voxel-size", "0.07",
                   "--precision", "2")
        self.assertEqual(done.returncode, 3, "the test needs a surface that is not valid")
        options = {"adaptivity": 1, "voxel_size": 0.07, "precision": 2}
        for make in (lambda: vdb_offset.iso_surface(soup, faces, 0.03, **options),
                     lambda: vdb_offset.iso_shell(soup, faces, 0.03, **options)):
            with self.assertRaises(vdb_offset.InvalidResult) as caught:
                make()
            error = caught.exception
            self.assertIsInstance(error, RuntimeError)
            self.assertIsInstance(error, vdb_offset.Error)
            # What the command says, but for how the option is spelt.
            self.assertIn(str(error), done.stderr.replace("--voxel-size", "voxel_size"))
            self.assertFalse(error.statistics["surface"]["valid"])

    def test_hollow_solids(self):
        for distance in (-0.1, 0.1):
            solid = self.check_iso([f"--distance={distance}", "--shell"],
                                   lambda *mesh, **options: vdb_offset.iso_shell(*mesh, distance, **options))
            mine = solid.vertices[:8] if distance < 0 else solid.vertices[-8:]
            self.check_bits(mine, CUBE)
            self.assertEqual(np.count_nonzero(solid.parts == (distance > 0)), 6)

    def test_hollow_solid_of_two_iso_surfaces(self):
        solid = self.check_iso(["--distance=0.1", "--shell", "--inner=0.15"],
                               lambda *mesh, **options: vdb_offset.iso_shell(*mesh, 0.1, inner=0.15, **options))
        self.assertTrue(solid.statistics["shell"]["closed"])
        self.assertGreater(len(np.unique(solid.parts)), 1)
        self.assertIn("inner_surface", solid.statistics)

    def test_hollow_solids_that_cannot_be(self):
        for distance, inner in ((0.1, -0.1), (-0.1, 0.1), (0.1, "0.1 + x"), ("0.1 + x", None), (0, None)):
            with self.assertRaises(ValueError):
                vdb_offset.iso_shell(CUBE, QUADS, distance, inner=inner, voxel_size=0.1)
        with self.assertRaisesRegex(vdb_offset.InvalidInput, "inside"):
            vdb_offset.iso_shell(CUBE, QUADS[:3], 0.1, voxel_size=0.1)
