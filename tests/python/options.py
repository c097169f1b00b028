# SPDX-License-Identifier: Apache-2.0
"""The keywords: what signatures, `help()` and the stubs say of them, and what they take."""
import importlib.machinery
import importlib.util
import inspect
import os
import pydoc
import subprocess
import sys
import unittest

import numpy as np

import vdb_offset
from beside import CUBE, QUADS, ROOT
from vdb_offset import _calls, _options, meshes


def functions():
    return [getattr(vdb_offset, name) for name in vdb_offset.__all__ if inspect.isfunction(getattr(vdb_offset, name))]


class Options(unittest.TestCase):
    def test_signatures_list_every_option(self):
        parameters = inspect.signature(vdb_offset.offset).parameters
        self.assertIsNone(parameters["corners"].default)
        self.assertIn("miter", str(parameters["corners"].annotation))
        self.assertEqual([name for name in parameters if name not in _options.OPTIONS], ["vertices", "faces", "distance"])
        for function in functions():
            kinds = {each.kind for each in inspect.signature(function).parameters.values()}
            self.assertNotIn(inspect.Parameter.VAR_KEYWORD, kinds, function.__name__)

    def test_every_option_is_in_a_signature(self):
        listed = {name for function in functions() for name in inspect.signature(function).parameters}
        self.assertEqual(set(_options.OPTIONS) - listed, set())

    def test_help_tells_of_each(self):
        for function in functions():
            text = pydoc.render_doc(function, renderer=pydoc.plaintext)
            for name, parameter in inspect.signature(function).parameters.items():
                if parameter.kind is inspect.Parameter.KEYWORD_ONLY:
                    self.assertIn(f":param {name}: ", text, function.__name__)
            self.assertNotIn(":param options:", text)

    def test_defaults_are_the_ones_that_hold(self):
        expected = vdb_offset.offset(CUBE, QUADS, 0.1)
        parameters = inspect.signature(vdb_offset.offset).parameters.values()
        given = {each.name: each.default for each in parameters if each.kind is inspect.Parameter.KEYWORD_ONLY}
        found = vdb_offset.offset(CUBE, QUADS, 0.1, **given)
        self.assertTrue((found.positions == expected.positions).all())
        self.assertEqual(found.statistics["miters"], expected.statistics["miters"])

    def test_stubs_are_those_of_the_signatures(self):
        loader = importlib.machinery.SourceFileLoader("python_stubs", os.path.join(ROOT, "scripts", "python_stubs"))
        stubs = importlib.util.module_from_spec(importlib.util.spec_from_loader("python_stubs", loader))
        loader.exec_module(stubs)
        for module, name in ((_calls, "_calls.pyi"), (meshes, "meshes.pyi")):
            with open(os.path.join(ROOT, "python", "vdb_offset", name), encoding="utf-8") as stub:
                self.assertEqual(stub.read(), stubs.stubs_of(module), "run scripts/python_stubs")

    def test_stubs_can_be_read(self):
        for name in ("_calls.pyi", "meshes.pyi"):
            path = os.path.join(ROOT, "python", "vdb_offset", name)
            with open(path, encoding="utf-8") as stub:
                text = stub.read().replace("from ._", "from vdb_offset._")
            names = {}
            exec(compile(text, path, "exec"), names)  # pylint: disable=exec-used
            for function in functions():
                if function.__name__ in names:
                    stubbed = inspect.signature(names[function.__name__])
                    self.assertEqual(stubbed, inspect.signature(function), function.__name__)

    def test_import_without_docstrings(self):
        code = "import vdb_offset as o; print(o.offset.__doc__, o.offset.__kwdefaults__)"
        done = subprocess.run([sys.executable, "-B", "-OO", "-c", code], capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.strip(), "None None")

    def test_memory_as_a_text(self):
        def offset(size):
            return vdb_offset.offset(CUBE, QUADS, 0.1, voxel_size=1e-3, max_memory=size)

        for little in ("10M", "10 MiB", "10mb", "+1e4K", "10000000B", 10**7, "0.01G", "1e-5T"):
            with self.subTest(little), self.assertRaises(vdb_offset.OutOfBudget):
                offset(little)
        for much in ("4G", "1T", 0, 2**32):
            vdb_offset.offset(CUBE, QUADS, 0.1, max_memory=much)
        for wrong in ("0", "4X", "G", "-1G", "", "nan", "2e30", -1, 1.5, True, 2**70, [1]):
            with self.subTest(wrong), self.assertRaisesRegex(vdb_offset.InvalidOption, "max_memory: expected"):
                offset(wrong)

    def test_clearance_as_a_text(self):
        for wrong in ("-1%", "1 foot", "", -0.1, float("nan"), True, [1], "x"):
            with self.subTest(wrong), self.assertRaisesRegex(vdb_offset.InvalidOption, "clearance: expected"):
                vdb_offset.offset(CUBE, QUADS, 0.1, obstacles=(CUBE + 3, QUADS), clearance=wrong)
            with self.subTest(wrong), self.assertRaisesRegex(vdb_offset.InvalidOption, "clearance: expected"):
                vdb_offset.fit(CUBE, QUADS, (CUBE + 3, QUADS), wrong)

    def test_what_does_not_go_together(self):
        near, box = (CUBE + 3, QUADS), (CUBE, QUADS, 0.1)
        square, faces = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), np.array([[0, 1, 2, 3]])
        cases = [(vdb_offset.offset, box, {"clearance": 0.1}, "clearance needs obstacles"),
                 (vdb_offset.offset, box, {"clearance": 0}, "clearance needs obstacles"),
                 (vdb_offset.check, (CUBE, QUADS, CUBE), {"clearance": 0.1}, "clearance needs obstacles"),
                 (vdb_offset.offset, box, {"miter_limit": 4, "corners": "round"}, "miter_limit needs corners='miter'"),
                 (vdb_offset.offset_curves, (square, faces[:, [0, 1]], 0.1), {"corners": "round", "miter_limit": 4}, "miter_limit needs"),
                 (vdb_offset.offset, box, {"voxel_size": 0.1, "voxels_per_distance": 2}, "voxel size or voxels per"),
                 (vdb_offset.offset, box, {"distance_z": 0.2, "obstacles": near}, "distance_z and obstacles exclude"),
                 (vdb_offset.check, (CUBE, QUADS, CUBE, 0.1), {"distance_z": 0.2, "obstacles": near}, "distance_z and obs"),
                 (vdb_offset.check, (CUBE, QUADS, CUBE, 0.1), {"distance_z": 0.2, "tolerance": "1%"}, "distance_z and tol"),
                 (vdb_offset.layers, (CUBE, QUADS, [0.1]), {"growth": 1.2}, "growth and heights exclude each other"),
                 (vdb_offset.layers, (CUBE, QUADS, [0.1]), {"first": 0.1}, "first and heights exclude each other"),
                 (vdb_offset.layers, (CUBE, QUADS, [0.1]), {"total": 0.1}, "total and heights exclude each other"),
                 (vdb_offset.layers, (CUBE, QUADS, [0.1]), {"count": 2}, "count: expected 1, as many as"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 2, "first": 0.1, "total": 0.3, "growth": 1.2},
                  "a count with two of first, total, last and growth"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 2}, "one of first, total and last"),
                 (vdb_offset.layers, (CUBE, QUADS), {"total": 0.3, "last": 0.1}, "a count with one of first"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 2, "first": 0.1, "total": 0.1}, "below the total"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 2, "first": 0.1, "total": -0.3}, "one sign"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 0, "first": 0.1}, "count: expected a whole number, 1"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 1001, "first": 0.1}, "count: expected a whole number, 1"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 2.0, "first": 0.1}, "count: expected a whole number, 1"),
                 (vdb_offset.layers, (CUBE, QUADS), {"count": 2, "first": 0.1, "growth": 11}, "growth: expected a number"),
                 (vdb_offset.fit, (CUBE, QUADS, near, 0), {}, "clearance: expected"),
                 (vdb_offset.iso_surface, (CUBE, QUADS, "0.1 + 0"), {}, "distance: expected a number"),
                 (vdb_offset.iso_surface, (CUBE, QUADS, [0.1] * 8), {}, "distance: expected a number"),
                 (vdb_offset.iso_surface, (CUBE, QUADS, 0), {}, "distance: expected")]
        for function, arguments, options, text in cases:
            with self.subTest(str(options)), self.assertRaisesRegex(ValueError, text) as caught:
                function(*arguments, **options)
            self.assertIsInstance(caught.exception, vdb_offset.Error)
        # None is as good as nothing.
        vdb_offset.offset(*box, clearance=None, miter_limit=None, distance_z=None)
        self.assertEqual(len(vdb_offset.layers(CUBE, QUADS, [0.1, 0.2], count=2, corners="miter").cell_types), 12)

    def test_unknown_keywords_are_refused_by_name(self):
        for function, arguments in ((vdb_offset.shell, (CUBE, QUADS, 0.1)), (vdb_offset.check, (CUBE, QUADS, CUBE)),
                                    (vdb_offset.layers, (CUBE, QUADS, [0.1])), (vdb_offset.iso_surface, (CUBE, QUADS, 0.1))):
            with self.assertRaisesRegex(TypeError, f"{function.__name__}\\(\\) got an unexpected keyword argument 'corner'"):
                function(*arguments, corner="miter")
