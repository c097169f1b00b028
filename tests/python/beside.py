# SPDX-License-Identifier: Apache-2.0
"""The command, for tests of the package that compare what both make."""
import functools
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

CUBE = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
QUADS = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])


def triangles(quads):
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


class Run:
    """What the command makes of a file, in a folder that goes away."""

    #: Its path, set before tests begin.
    command = ""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def __call__(self, *arguments):
        quiet = [] if arguments[0] == "check" else ["--quiet"]
        done = subprocess.run([self.command, *arguments, *quiet], cwd=self.folder.name, capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise RuntimeError(done.stderr)
        return done

    def report(self, name="report.json"):
        with open(self.path(name), encoding="utf-8") as report:
            return json.load(report)

    def write(self, name, vertices, faces):
        with open(self.path(name), "w", encoding="ascii") as out:
            for x, y, z in vertices:
                out.write(f"v {float(x)!r} {float(y)!r} {float(z)!r}\n")
            for face in faces:
                out.write("f " + " ".join(str(v + 1) for v in face) + "\n")

    def read(self, name):
        vertices, faces = [], []
        with open(self.path(name), encoding="ascii") as lines:
            for line in lines:
                words = line.split()
                if words[:1] == ["v"]:
                    vertices.append([float(w) for w in words[1:4]])
                elif words[:1] == ["f"]:
                    faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
        return np.array(vertices), faces


#: Of shapes that are made with fewer faces than in their scenes.
FEWER = {"gear": {"stacks": 1}, "patch_wavy": {"divisions": 16}, "plates_open": {"divisions": 10},
         "torus": {"segments": 48, "sides": 20}, "wedge": {"divisions": 10}}


@functools.lru_cache(maxsize=None)
def made_shape(scene):
    """The file of a scene's shape."""
    run = Run()
    with open(os.path.join(ROOT, "scenes", scene + ".json"), encoding="utf-8") as file:
        asked = json.load(file)
    asked["shape"].update(FEWER.get(scene, {}))
    with open(run.path("scene.json"), "w", encoding="utf-8") as file:
        json.dump({"shape": asked["shape"], "offset": asked["offset"]}, file)
    run("scene.json", "shape.obj", "--distance", "0", "--precision", "17")
    with open(run.path("shape.obj"), encoding="ascii") as file:
        text = file.read()
    run.folder.cleanup()
    return text


def shape_of(scene, run):
    """A scene's shape as arrays, with as few faces as show what is to be seen, and as `shape.obj`."""
    with open(run.path("shape.obj"), "w", encoding="ascii") as file:
        file.write(made_shape(scene))
    vertices, faces = run.read("shape.obj")
    return vertices, np.array(faces)


class BesideTheCommand(unittest.TestCase):
    """Results are the same bits, and statistics the same numbers, whichever way the library is called."""

    #: What of a report differs from run to run, or is about files and the command line.
    of_the_run = {"input", "output", "options", "seconds", "peak_memory_bytes"}

    #: What the command says of its result.
    said = ("verdict", "warnings", "notes")

    def setUp(self):
        self.run_command = Run()
        self.addCleanup(self.run_command.folder.cleanup)

    def check_report(self, statistics, report, but=()):
        """Statistics are a report of the command, but for what is named."""
        found, expected = json.loads(json.dumps(statistics)), dict(report)
        for key in self.said:
            del expected[key]
        self.assertEqual(set(found), set(expected))
        # The command holds its files besides, Python the interpreter.
        for figures in (found, expected):
            if "grid" in figures:
                figures["grid"] = {key: value for key, value in figures["grid"].items() if key != "estimated_bytes"}
        for key in set(found) - self.of_the_run - set(but):
            self.assertEqual(found[key], expected[key], key)

    def check_faces(self, faces, made):
        """Faces are those that were read from a file."""
        corners = faces[1] if isinstance(faces, tuple) else np.asarray(faces).ravel()
        self.assertEqual([v for face in made for v in face], corners.tolist())

    def check_bits(self, found, made):
        """Positions are those that were read from a file, to the last bit."""
        self.assertEqual(found.shape, made.shape)
        self.assertTrue((found == made).all())
