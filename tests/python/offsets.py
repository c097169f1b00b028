# SPDX-License-Identifier: Apache-2.0
"""Offsets of meshes, beside the command's."""
import numpy as np

import vdb_offset
from beside import CUBE, QUADS, BesideTheCommand, shape_of


class Offsets(BesideTheCommand):
    def check(self, scene, distance, arguments=(), **options):
        run = self.run_command
        vertices, faces = shape_of(scene, run)
        run(run.path("shape.obj"), run.path("made.obj"), f"--distance={distance}", "--precision", "17", "--report",
            run.path("report.json"), *arguments)
        result = vdb_offset.offset(vertices, faces, distance, precision=17, **options)
        made, _ = run.read("made.obj")
        self.check_bits(result.positions, made)
        self.assertFalse((made == vertices).all())
        self.check_report(result.statistics, run.report())
        return result

    def test_outward(self):
        self.check("bumpy_sphere", "3%")

    def test_inward_where_fronts_meet(self):
        self.assertIn("collision", self.check("gear", "-6%").state_names)

    def test_merge(self):
        self.check("bumpy_sphere", "4%", ["--collision", "merge"], collision="merge")

    def test_miter(self):
        self.check("gear", "0.5%", ["--corners", "miter", "--miter-limit", "3"], corners="miter", miter_limit=3)

    def test_expression(self):
        self.check("torus", "0.05 + 0.02*sin(4*pi*z) + 0.01*nx")

    def test_eikonal(self):
        self.check("torus", "2%", ["--solver", "eikonal", "--voxel-size", "0.05"], solver="eikonal", voxel_size=0.05)

    def test_open_surface_with_symmetry(self):
        self.check("patch", "0.2", ["--symmetry", "none"], symmetry=False)

    def test_symmetry_as_a_text(self):
        self.check("patch", "0.2", ["--symmetry", "none"], symmetry="none")
        self.check("bumpy_sphere", "2%", ["--symmetry", "x=0"], symmetry="x=0")
        self.check("bumpy_sphere", "2%", ["--symmetry", "x=0", "--symmetry", "z=0"], symmetry=["x=0", "z=0"])

    def test_symmetry_as_a_text_of_factors(self):
        # A wavy sheet, one border of which lies in the plane.
        along, across = (each.ravel() for each in np.meshgrid(np.linspace(0, 3, 31), np.arange(3.0)))
        sheet = np.stack([3 * along + 0.2 * across, 0.3 * across - 2 * along, np.sin(4 * along + across)], 1)
        first = np.arange(93).reshape(3, 31)[:-1, :-1].ravel()
        faces = np.stack([first, first + 1, first + 32, first + 31], 1)
        run = self.run_command
        run.write("shape.obj", sheet, faces)
        run("shape.obj", "made.obj", "--distance=0.1", "--symmetry", "0.2,0.3,0,-0.0", "--symmetry", "none", "--precision", "17")
        made, _ = run.read("made.obj")
        for plane in ("0.2,0.3,0,-0.0", (0.2, 0.3, 0, -0.0), np.array([0.2, 0.3, 0, 0])):
            for planes in ([plane, "none"], ("none", plane)):
                found = vdb_offset.offset(sheet, faces, 0.1, symmetry=planes, precision=17)
                self.check_bits(found.positions, made)
        free = vdb_offset.offset(sheet, faces, 0.1, symmetry="none", precision=17)
        self.assertFalse((free.positions == made).all())

    def test_symmetry_that_means_nothing(self):
        for wrong in ("w=0", "x=", "x", "x=a", "", "1,2,3", "1,2,3,4,5", "0,0,0,1", "1,,0,0", "1,0,0,inf", "None", 3, 0.5, [3],
                      ["x=0", "all"], [(0, 0, 0, 1)], [(1, 0, 0)], (1, 0, 0, 1), [True], b"x=0", {"x": 0}):
            with self.subTest(str(wrong)), self.assertRaisesRegex(vdb_offset.InvalidOption, "^symmetry: expected"):
                vdb_offset.offset(CUBE, QUADS, 0.1, symmetry=wrong)

    def test_array_of_distances(self):
        run = self.run_command
        vertices, faces = shape_of("torus", run)
        each = 0.02 + 0.01 * vertices[:, 0]
        with open(run.path("each.txt"), "w", encoding="ascii") as out:
            out.writelines(f"{float(d)!r}\n" for d in each)
        run(run.path("shape.obj"), run.path("made.obj"), "--distance-from", run.path("each.txt"), "--precision", "17")
        result = vdb_offset.offset(vertices, faces, each)
        self.check_bits(result.positions, run.read("made.obj")[0])
        self.assertTrue((result.distances == each).all())

    def test_several_distances(self):
        run = self.run_command
        vertices, faces = shape_of("gear", run)
        run(run.path("shape.obj"), run.path("made_{i}.obj"), "--distance=0.02", "--distance=-1%", "--precision", "17",
            "--report", run.path("report_{i}.json"))
        for i, result in enumerate(vdb_offset.offset_several(vertices, faces, [0.02, "-1%"], precision=17)):
            self.check_bits(result.positions, run.read(f"made_00{i + 1}.obj")[0])
            self.check_report(result.statistics, run.report(f"report_00{i + 1}.json"))

    def test_distances_by_axis(self):
        run = self.run_command
        vertices, faces = shape_of("torus", run)
        run(run.path("shape.obj"), run.path("made.obj"), "--distance-xy=0.03", "--distance-z=0.06", "--precision", "17")
        result = vdb_offset.offset(vertices, faces, 0.03, distance_z=0.06, precision=17)
        self.check_bits(result.positions, run.read("made.obj")[0])
        self.assertTrue(vdb_offset.check(vertices, faces, result.positions, 0.03, distance_z=0.06).valid)
        for wrong in (-0.06, "-1%", 1e9, "0.03 + 0", [0.06], float("nan"), True):
            with self.assertRaises(vdb_offset.InvalidOption):
                vdb_offset.offset(vertices, faces, 0.03, distance_z=wrong)
        with self.assertRaises(vdb_offset.InvalidOption):
            vdb_offset.offset_several(vertices, faces, [0.03, 0.04], distance_z=0.06)

    def test_distances_by_axis_of_which_one_is_0(self):
        run = self.run_command
        vertices, faces = shape_of("torus", run)
        for xy, z in ((0.03, 0), (0, 0.03), ("1%", "0"), ("0%", "-1.1%"), (-0.03, "0%")):
            with self.subTest(str((xy, z))):
                run("shape.obj", "made.obj", f"--distance-xy={xy}", f"--distance-z={z}", "--precision", "17", "--report",
                    "report.json")
                result = vdb_offset.offset(vertices, faces, xy, distance_z=z, precision=17)
                self.check_bits(result.positions, run.read("made.obj")[0])
                self.assertFalse((result.positions == vertices).all())
                self.check_report(result.statistics, run.report())
                run("check", "shape.obj", "made.obj", f"--distance-xy={xy}", f"--distance-z={z}", "--precision", "17", "--report",
                    "check.json")
                found = vdb_offset.check(vertices, faces, result.positions, xy, distance_z=z, precision=17)
                self.check_report(found.statistics, run.report("check.json"), ["source", "offset"])
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "distance_z: expected one other than 0"):
            vdb_offset.offset(vertices, faces, 0, distance_z=0)

    def read_paths(self, name):
        """The ways in a file, each a block of lines with a position each."""
        with open(self.run_command.path(name), encoding="ascii") as file:
            blocks = file.read().split("\n\n")
        return [np.array([line.split() for line in block.splitlines()], float) for block in blocks if block.strip()]

    def test_paths_of_a_fit(self):
        run = self.run_command
        near = CUBE * [1, 1, 0.5] + [0, 0, 1.02]
        run.write("cube.obj", CUBE, QUADS)
        run.write("near.obj", near, QUADS)
        run("cube.obj", "made.obj", "--fit", "near.obj", "--clearance", "0.05", "--paths", "ways.txt")
        fit = vdb_offset.fit(CUBE, QUADS, (near, QUADS), 0.05, paths=True)
        self.check_ways([path for path, moved in zip(fit.paths, (fit.positions != CUBE).any(axis=1)) if moved], "ways.txt")
        self.assertEqual(len(fit.paths), 8)
        self.assertIsNone(vdb_offset.fit(CUBE, QUADS, (near, QUADS), 0.05).paths)

    def check_ways(self, paths, name):
        ways = self.read_paths(name)
        self.assertEqual(len(paths), len(ways))
        for path, way in zip(paths, ways):
            self.check_bits(path, way)

    def test_paths_of_a_shell(self):
        run = self.run_command
        run.write("cube.obj", CUBE, QUADS)
        run("cube.obj", "made.obj", "--shell", "--distance=0.1", "--paths", "ways.txt")
        self.check_ways(vdb_offset.shell(CUBE, QUADS, 0.1, paths=True).paths, "ways.txt")
        self.assertIsNone(vdb_offset.shell(CUBE, QUADS, 0.1).paths)

    def test_tolerance(self):
        run = self.run_command
        run.write("cube.obj", CUBE, QUADS)
        run("cube.obj", "made.obj", "--distance=0.1", "--tolerance", "2%", "--refined-source", "source.obj", "--precision",
            "17")
        refined = vdb_offset.offset_to_tolerance(CUBE, QUADS, 0.1, "2%", precision=17)
        made, made_faces = run.read("made.obj")
        self.assertTrue((made == refined.positions).all())
        self.assertTrue((run.read("source.obj")[0] == refined.source).all())
        corners = refined.faces[1] if isinstance(refined.faces, tuple) else refined.faces.ravel()
        self.assertEqual([v for face in made_faces for v in face], corners.tolist())
        self.assertEqual(refined.statistics["certified"]["certified"], 1)
        added = refined.added
        there = np.einsum("ik,ikj->ij", added["shares"], CUBE[added["vertices"]])
        np.testing.assert_allclose(there, refined.source[8:], atol=1e-12)

    def test_arcs(self):
        run = self.run_command
        run.write("cube.obj", CUBE, QUADS)
        run("cube.obj", "made.obj", "--distance=0.1", "--corners", "arc", "--precision", "17")
        opened = vdb_offset.offset_to_tolerance(CUBE, QUADS, 0.1, "1%", corners="arc", precision=17)
        self.assertTrue((run.read("made.obj")[0] == opened.positions).all())
        self.assertEqual(opened.parents[:6].tolist(), list(range(6)))
        self.assertGreater(len(opened.parents), 6 + 12)
        self.assertTrue((opened.source[8:] == CUBE[opened.added["vertices"][:, 0]]).all())
        found = vdb_offset.check(opened.source, opened.faces, opened.positions, 0.1, corners="arc", tolerance="1%")
        self.assertTrue(found.valid)
        self.assertEqual(found.statistics["certified"]["certified"], 1)

    def test_fit(self):
        run = self.run_command
        near = CUBE * [1, 1, 0.5] + [0, 0, 1.02]
        run.write("cube.obj", CUBE, QUADS)
        run.write("near.obj", near, QUADS)
        run("cube.obj", "made.obj", "--fit", "near.obj", "--clearance", "0.05", "--precision", "17")
        result = vdb_offset.fit(CUBE, QUADS, (near, QUADS), 0.05, precision=17)
        self.check_bits(result.positions, run.read("made.obj")[0])
        self.assertFalse((result.positions == CUBE).all())

    def test_check(self):
        run = self.run_command
        vertices, faces = shape_of("gear", run)
        result = vdb_offset.offset(vertices, faces, "0.5%", corners="miter")
        found = vdb_offset.check(vertices, faces, result.positions, "0.5%", corners="miter", tolerance="1%")
        self.assertTrue(found.valid)
        self.assertTrue((found.states == result.states).all())
        self.assertGreater(found.statistics["certified"]["certified"], 0.9)
        turned = vdb_offset.check(vertices, faces, 2 * vertices[:, [1, 0, 2]], "0.5%")
        self.assertFalse(turned.valid)

    def test_check_in_planes(self):
        free = vdb_offset.offset(CUBE, QUADS, 0.05)
        held = vdb_offset.offset(CUBE, QUADS, 0.05, symmetry="z=1")
        self.assertTrue(vdb_offset.check(CUBE, QUADS, free.positions, 0.05).valid)
        self.assertFalse(vdb_offset.check(CUBE, QUADS, free.positions, 0.05, symmetry="z=1").valid)
        self.assertTrue(vdb_offset.check(CUBE, QUADS, held.positions, 0.05, symmetry="z=1").valid)

    def test_check_finds_what_the_command_finds(self):
        run = self.run_command
        vertices, faces = shape_of("gear", run)
        run("shape.obj", "made.obj", "--distance=0.5%", "--corners", "round", "--precision", "17")
        run("check", "shape.obj", "made.obj", "--distance=0.5%", "--corners", "round", "--tolerance", "1%", "--precision", "17", "--report",
            "report.json")
        found = vdb_offset.check(vertices, faces, run.read("made.obj")[0], "0.5%", tolerance="1%", corners="round",
                                 precision=17)
        self.check_report(found.statistics, run.report(), ["source", "offset"])
        self.assertLess(found.statistics["certified"]["certified"], 1)

    def check_face_errors(self, found, name, faces):
        """Errors of faces are those that a file has, to the last bit, and some are numbers other than 0."""
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
        except ImportError:
            self.skipTest("VTK's modules are not installed")
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(self.run_command.path(name))
        reader.Update()
        written = vtk_to_numpy(reader.GetOutput().GetCellData().GetArray("face_error"))
        self.assertEqual((found.dtype, found.shape), (np.float32, (len(faces),)))
        self.assertEqual(written.dtype, np.float32)
        np.testing.assert_array_equal(found.view(np.uint32), written.view(np.uint32))
        self.assertGreater(np.nanmax(found), 0)

    def test_errors_of_faces(self):
        run = self.run_command
        vertices, faces = shape_of("torus", run)
        part = np.arange(0, len(faces), 3)
        options = {"corners": "miter", "precision": 17, "face_errors": True}
        run("shape.obj", "made_{i}.obj", "--distance=0.05", "--distance=-4%", "--corners", "miter", "--states", "states_{i}.vtp",
            "--precision", "17")
        for i, each in enumerate(vdb_offset.offset_several(vertices, faces, [0.05, "-4%"], **options)):
            self.check_face_errors(each.face_errors, f"states_00{i + 1}.vtp", faces)
        run("check", "shape.obj", "made_001.obj", "--distance=0.05", "--corners", "miter", "--states", "states.vtp", "--precision",
            "17")
        found = vdb_offset.check(vertices, faces, run.read("made_001.obj")[0], 0.05, **options)
        self.check_face_errors(found.face_errors, "states.vtp", faces)
        run("shape.obj", "made.obj", "--shell", "--distance=0.05", "--inner=0.02", "--states", "states.vtp")
        shell = vdb_offset.shell(vertices, faces, 0.05, inner=0.02, face_errors=True)
        self.check_face_errors(shell.face_errors, "states.vtp", faces)
        # Nothing is asked of the other faces.
        some = vdb_offset.offset(vertices, faces, 0.05, only=part, **options).face_errors
        self.assertTrue((np.isnan(some) == ~np.isin(np.arange(len(faces)), part)).all())

    def test_errors_of_faces_of_a_fit(self):
        run = self.run_command
        near = CUBE * [1, 1, 0.5] + [0, 0, 1.02]
        run.write("cube.obj", CUBE, QUADS)
        run.write("near.obj", near, QUADS)
        run("cube.obj", "made.obj", "--fit", "near.obj", "--clearance", "0.05", "--states", "states.vtp")
        fit = vdb_offset.fit(CUBE, QUADS, (near, QUADS), 0.05, face_errors=True)
        self.check_face_errors(fit.face_errors, "states.vtp", QUADS)

    def test_errors_of_faces_that_nobody_asks_for(self):
        for result in (vdb_offset.offset(CUBE, QUADS, 0.1), vdb_offset.shell(CUBE, QUADS, 0.1, face_errors=False),
                       vdb_offset.check(CUBE, QUADS, CUBE, 0.1), vdb_offset.offset_to_tolerance(CUBE, QUADS, 0.1, "5%"),
                       vdb_offset.offset_curves(CUBE[:4], np.array([[0, 1], [1, 3]]), 0.1)):
            self.assertIsNone(result.face_errors)
        for result in (vdb_offset.offset(CUBE, QUADS, 0, face_errors=True),
                       vdb_offset.shell(CUBE, QUADS, 0, inner=0.1, face_errors=True),
                       vdb_offset.check(CUBE, QUADS, CUBE, 0, face_errors=True)):
            self.assertTrue(np.isnan(result.face_errors).all())
            self.assertEqual(result.face_errors.shape, (6,))
        for function, arguments in ((vdb_offset.layers, (CUBE, QUADS, [0.1])), (vdb_offset.offset_to_tolerance, (CUBE, QUADS, 0.1, 1)),
                                    (vdb_offset.offset_curves, (CUBE[:4], np.array([[0, 1]]), 0.1))):
            with self.assertRaisesRegex(TypeError, "unexpected keyword argument 'face_errors'"):
                function(*arguments, face_errors=True)
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "face_errors: expected True or False"):
            vdb_offset.offset(CUBE, QUADS, 0.1, face_errors="all")

    def test_clearance_in_percent(self):
        run = self.run_command
        above = CUBE + [0, 0, 1.1]
        run.write("cube.obj", CUBE, QUADS)
        run.write("above.obj", above, QUADS)
        run("cube.obj", "made.obj", "--distance=0.2", "--obstacle", "above.obj", "--clearance", "2%", "--precision", "17",
            "--report", "report.json")
        result = vdb_offset.offset(CUBE, QUADS, 0.2, obstacles=(above, QUADS), clearance="2%", precision=17)
        self.check_bits(result.positions, run.read("made.obj")[0])
        self.check_report(result.statistics, run.report())
        run("cube.obj", "fit.obj", "--fit", "above.obj", "--clearance", "8%", "--precision", "17")
        fit = vdb_offset.fit(CUBE, QUADS, (above, QUADS), "8%", precision=17)
        self.check_bits(fit.positions, run.read("fit.obj")[0])
        self.assertFalse((fit.positions == CUBE).all())

    def write_with_texture(self, name, vertices, faces, texture, corners):
        with open(self.run_command.path(name), "w", encoding="ascii") as out:
            out.writelines("v {!r} {!r} {!r}\n".format(*map(float, v)) for v in vertices)
            out.writelines("vt {!r} {!r}\n".format(*map(float, uv)) for uv in texture)
            for face, of_face in zip(faces, corners):
                out.write("f " + " ".join(f"{v + 1}/{t + 1}" for v, t in zip(face, of_face)) + "\n")

    def test_texture_of_vertices(self):
        run = self.run_command
        vertices, faces = shape_of("torus", run)
        texture = vertices[:, :2] ** 2
        self.write_with_texture("with.obj", vertices, faces, texture, faces)
        run("with.obj", "made.obj", "--distance", "0.02 + 0.03*u*v", "--precision", "17")
        result = vdb_offset.offset(vertices, faces, "0.02 + 0.03*u*v", texture=texture, precision=17)
        self.check_bits(result.positions, run.read("made.obj")[0])
        self.assertGreater(np.ptp(result.distances), 0.005)

    def test_texture_of_corners_has_seams(self):
        run = self.run_command
        corners = np.arange(24).reshape(6, 4)
        texture = np.stack([np.arange(24) / 24, np.arange(24) % 5], 1)
        self.write_with_texture("with.obj", CUBE, QUADS, texture, corners)
        run("with.obj", "made.obj", "--distance", "0.1 + 0.1*u + 0.01*v", "--precision", "17")
        for given in (texture, texture.reshape(6, 4, 2), texture.reshape(6, 4, 2).tolist()):
            result = vdb_offset.offset(CUBE, QUADS, "0.1 + 0.1*u + 0.01*v", texture=given, precision=17)
            self.check_bits(result.positions, run.read("made.obj")[0])
        # A corner without texture leaves its vertex to the next one.
        texture[QUADS.ravel().tolist().index(2)] = np.nan
        other = vdb_offset.offset(CUBE, QUADS, "u", texture=texture).distances
        self.assertEqual(other[2], QUADS.ravel().tolist().index(2, 2) / 24)

    def test_texture_that_does_not_fit(self):
        for texture in (np.zeros((7, 2)), np.zeros((8, 3)), np.zeros(16), np.zeros((8, 2), bool), "u", np.zeros((3, 4, 2))):
            with self.assertRaisesRegex(vdb_offset.InvalidInput, "^texture: expected"):
                vdb_offset.offset(CUBE, QUADS, "u", texture=texture)
        with self.assertRaisesRegex(vdb_offset.InvalidInput, "without u and v"):
            vdb_offset.offset(CUBE, QUADS, "u")
        with self.assertRaises(vdb_offset.InvalidInput):
            vdb_offset.offset(CUBE, QUADS, "u", texture=np.full((8, 2), np.nan))

    def test_field_is_saved(self):
        run = self.run_command
        vertices, faces = shape_of("torus", run)
        run("shape.obj", "made.obj", "--distance=0.05", "--save-vdb", "made.vdb")
        vdb_offset.offset(vertices, faces, 0.05, save_vdb=run.path("field.vdb"))
        with open(run.path("made.vdb"), "rb") as made, open(run.path("field.vdb"), "rb") as field:
            expected, found = made.read(), field.read()
        # Names and an identifier differ, and so do offsets in the file; the values of both grids do not.
        pieces = [expected[at:at + 64] for at in range(0, len(expected), 64)]
        self.assertGreater(sum(piece in found for piece in pieces) / len(pieces), 0.95)
        vdb_offset.offset(vertices, faces, 0.06, save_vdb=run.path("other.vdb"))
        with open(run.path("other.vdb"), "rb") as field:
            found = field.read()
        self.assertLess(sum(piece in found for piece in pieces) / len(pieces), 0.95)

    def test_field_that_cannot_be_saved(self):
        path = self.run_command.path("field.vdb")
        for options, kind in (({"save_vdb": self.run_command.path("no/field.vdb")}, vdb_offset.Error),
                              ({"save_vdb": path, "distance_z": 0.2}, vdb_offset.InvalidOption),
                              ({"save_vdb": str(path) + "\0x"}, vdb_offset.InvalidOption)):
            with self.assertRaises(kind):
                vdb_offset.offset(CUBE, QUADS, 0.1, **options)
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "save_vdb: expected a distance other than 0"):
            vdb_offset.offset_several(CUBE, QUADS, [0, 0], save_vdb=path)
        with self.assertRaises(TypeError):
            vdb_offset.offset(CUBE, QUADS, 0.1, save_vdb=1.5)
        with self.assertRaisesRegex(vdb_offset.InvalidOption, "save_vdb: expected the name of a file"):
            vdb_offset.offset(CUBE, QUADS, 0.1, save_vdb="")

    def test_tolerances_that_cannot_be(self):
        for wrong in (0, -1, "x", "-1%", None, [1], float("nan")):
            with self.subTest(wrong), self.assertRaisesRegex(vdb_offset.InvalidOption, "^tolerance: expected"):
                vdb_offset.offset_to_tolerance(CUBE, QUADS, 0.1, wrong)
            if wrong is not None:
                with self.assertRaisesRegex(vdb_offset.InvalidOption, "^tolerance: expected"):
                    vdb_offset.check(CUBE, QUADS, CUBE, 0.1, tolerance=wrong)
