# SPDX-License-Identifier: Apache-2.0
"""Calls that take a while: what they tell and ask, what ends them, and what goes on meanwhile."""
import contextlib
import io
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

import vdb_offset
from beside import CUBE, QUADS, Run, shape_of


@contextlib.contextmanager
def control_c():
    """What presses Ctrl-C, once, and returns when the call has seen it: a second one would come after the call."""
    first, seen, before = threading.Lock(), threading.Event(), signal.getsignal(signal.SIGINT)
    interval = sys.getswitchinterval()

    def see(number, frame):
        sys.setswitchinterval(60)  # no other thread gets a turn until the call is told
        seen.set()
        raise KeyboardInterrupt

    def press():
        if first.acquire(blocking=False):
            os.kill(os.getpid(), signal.SIGINT)
            seen.wait(60)

    signal.signal(signal.SIGINT, see)
    try:
        yield press
    finally:
        sys.setswitchinterval(interval)
        signal.signal(signal.SIGINT, before)


class LongCalls(unittest.TestCase):
    """What goes on during a call: some seconds of work, most of which are never done."""

    @classmethod
    def setUpClass(cls):
        run = Run()
        cls.mesh = shape_of("bumpy_sphere", run)
        run.folder.cleanup()

    def offset(self, **options):
        return vdb_offset.offset(*self.mesh, "1%", voxel_size=0.008, **options)

    def test_callback_is_told_and_cancels(self):
        told = []

        def progress(stage, share):
            told.append((stage, share))
            return len(told) < 5

        with self.assertRaises(vdb_offset.Cancelled):
            self.offset(progress=progress)
        self.assertGreaterEqual(len(told), 5)
        self.assertTrue(all(isinstance(stage, str) and 0 <= share <= 1 for stage, share in told))

    def test_shares_are_of_the_whole_call(self):
        calls = {
            "offset": lambda **options: self.offset(**options),
            "iso_surface_several": lambda **options: vdb_offset.iso_surface_several(*self.mesh, [0.2, 0.3], **options),
            "iso_shell": lambda **options: vdb_offset.iso_shell(*self.mesh, 0.3, inner=0.1, **options),
        }
        for name, call in calls.items():
            with self.subTest(name):
                shares = []
                call(progress=lambda stage, share: shares.append(share))
                self.assertEqual((shares[0], shares[-1]), (0, 1))
                self.assertEqual(shares, sorted(shares))

    def test_a_bar_by_tqdm(self):
        with self.assertRaisesRegex(ValueError, "expected a function or 'tqdm', got 'bar'"):
            self.offset(progress="bar")
        try:
            import tqdm  # noqa: F401
        except ImportError:
            with self.assertRaisesRegex(ImportError, "pip install tqdm"):
                self.offset(progress="tqdm")
            return
        text = io.StringIO()
        with contextlib.redirect_stderr(text):
            self.offset(progress="tqdm")
        self.assertIn("offset: 100 %|", text.getvalue())

    def test_what_the_callback_raises_is_raised(self):
        def progress(stage, share):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            self.offset(progress=progress)

    def test_control_c_ends_the_call(self):
        told = []
        with control_c() as press, self.assertRaises(KeyboardInterrupt):
            self.offset(progress=lambda stage, share: (told.append(stage), press()))
        self.assertLess(len(told), 3)

    def test_memory_is_asked_for_before_it_is_taken(self):
        told, asked = [], []

        def reserve(size):
            self.assertEqual(told, ["rasterise"] * 2)  # the mesh is sorted, to know the plan
            asked.append(size)

        result = self.offset(reserve=reserve, progress=lambda stage, share: told.append(stage))
        self.assertEqual(asked, [result.statistics["grid"]["estimated_bytes"]])
        self.assertIn("sweep", told)

    def test_memory_that_is_refused(self):
        for answer in (False, 0, np.False_):
            told = []
            with self.assertRaises(vdb_offset.Cancelled):
                self.offset(reserve=lambda size: answer, progress=lambda stage, share: told.append(stage))
            self.assertEqual(told, ["rasterise"] * 2)

        def fail(size):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            self.offset(reserve=fail)
        with self.assertRaises(TypeError):
            self.offset(reserve="4G")

    def test_other_threads_go_on_while_memory_is_waited_for(self):
        is_room, waits = threading.Event(), threading.Event()

        def make_room():
            waits.wait(60)
            is_room.set()

        def reserve(size):
            waits.set()
            return is_room.wait(60)

        thread = threading.Thread(target=make_room)
        thread.start()
        vdb_offset.offset(CUBE, QUADS, 0.1, reserve=reserve)
        thread.join()

    def test_control_c_ends_a_call_that_waits_for_memory(self):
        told = []
        with control_c() as press, self.assertRaises(KeyboardInterrupt):
            self.offset(reserve=lambda size: press(), progress=lambda stage, share: told.append(stage))
        self.assertNotIn("sweep", told)

    def test_every_function_asks_for_memory(self):
        square, faces = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float), np.array([[0, 1, 2, 3]])
        loop, near = (np.array([0, 5]), np.array([0, 1, 2, 3, 0])), CUBE * [1, 1, 0.5] + [0, 0, 1.02]
        calls = {"offset": (CUBE, QUADS, 0.1), "offset_several": (CUBE, QUADS, [0.1]), "shell": (CUBE, QUADS, 0.1),
                 "shell_several": (CUBE, QUADS, [0.1]), "offset_to_tolerance": (CUBE, QUADS, 0.1, "5%"),
                 "fit": (CUBE, QUADS, (near, QUADS), 0.05), "layers": (CUBE, QUADS, [0.1]), "iso_shell": (CUBE, QUADS, 0.1),
                 "iso_surface": (CUBE, QUADS, 0.1), "iso_surface_several": (CUBE, QUADS, [0.1]),
                 "structured_layers": (square, faces, [0.1]), "offset_curves": (square, loop, 0.1),
                 "offset_curves_several": (square, loop, [0.1]), "curve_layers": (square, loop, [0.1]),
                 "structured_curve_layers": (square, loop, [0.1])}
        for name, arguments in calls.items():
            with self.subTest(name), self.assertRaises(vdb_offset.Cancelled):
                getattr(vdb_offset, name)(*arguments, reserve=lambda size: False)

    def check(self, **options):
        vertices, faces = self.mesh
        return vdb_offset.check(vertices, faces, 1.01 * vertices, tolerance="0.1%", **options)

    def test_check_is_told_and_cancels(self):
        told = []

        def progress(stage, share):
            told.append((stage, share))
            return len(told) < 5

        with self.assertRaises(vdb_offset.Cancelled):
            self.check(progress=progress)
        self.assertEqual({stage for stage, share in told}, {"measure"})
        self.assertEqual(told[0][1], 0)
        quiet = self.check()
        # By one thread, as another one that has something to tell does not wait until it can.
        loud = self.check(threads=1, progress=lambda stage, share: told.append((stage, share)))
        self.assertTrue((quiet.achieved == loud.achieved).all())
        self.assertEqual(quiet.statistics, loud.statistics)
        self.assertEqual(max(share for stage, share in told), 1)

    def test_control_c_ends_a_check(self):
        told = []
        with control_c() as press, self.assertRaises(KeyboardInterrupt):
            self.check(progress=lambda stage, share: (told.append(share), press()))
        self.assertLess(len(told), 3)

    def test_numpy_false_cancels(self):
        with self.assertRaises(vdb_offset.Cancelled):
            self.offset(progress=lambda stage, share: np.False_)

    def test_python_ends_during_a_call_of_another_thread(self):
        code = ("import threading, time, numpy as np, vdb_offset as o; t = np.linspace(0, 6.28, 200); "
                "v = np.stack([np.cos(t), np.sin(t), 0 * t], 1); f = np.stack([np.arange(198), np.arange(1, 199), "
                "np.full(198, 199)], 1); e = threading.Event(); "
                "threading.Thread(target=lambda: o.offset(v, f, 0.1, voxel_size=0.005, progress=lambda s, x: e.set()), "
                "daemon=True).start(); e.wait(60)")
        done = subprocess.run([sys.executable, "-B", "-c", code], env=dict(os.environ), capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_other_threads_go_on(self):
        ticks, is_done = [], threading.Event()

        def tick():
            while not is_done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        start = time.monotonic()
        vdb_offset.offset(*self.mesh, "1%", voxel_size=0.02)
        end = time.monotonic()
        is_done.set()
        thread.join()
        during = [t for t in ticks if start < t < end]
        self.assertGreater(len(during), min(5, (end - start) / 0.05))
