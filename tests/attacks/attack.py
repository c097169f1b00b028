# SPDX-License-Identifier: Apache-2.0
"""What an attack is made of: files made on the spot, runs under limits, and what each must give.

A module of this folder holds attacks of one kind: functions marked with @attack, each of which gets a Place. `run` runs
them all. Every file is made here; none comes from elsewhere.
"""
import dataclasses
import os
import pathlib
import re
import resource
import subprocess
import time

ATTACKS = []

# An error is one line of at most so many characters, whatever the input.
LONGEST_LINE = 600
# Seconds that anything may take, others beside it, and of processors' time, whatever runs beside it; sanitized, so many
# times as long. What takes longest takes 12 s of either.
MOST_SECONDS = 60
MOST_PROCESSOR_SECONDS = 30
SANITIZED_FACTOR = 6
# The same from a signal to the end.
SOON = 5
SOON_PROCESSOR_SECONDS = 1


def attack(function):
    """Marks a function as an attack; its name, with its module's, names it."""
    ATTACKS.append(function)
    return function


def attack_each(cases):
    """Marks a function as one attack for each of `cases` (name to value), which it gets besides its Place."""
    def mark(function):
        for name, value in cases.items():
            def one(place, value=value):
                function(place, value)
            one.__module__ = function.__module__
            one.__name__ = f'{function.__name__}[{name}]'
            ATTACKS.append(one)
        return function
    return mark


class Failed(Exception):
    """What an attack must give, and did not."""


def processor_seconds():
    """Of all children that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def processor_seconds_so_far(process):
    """Of a child under way, or that nobody has waited for."""
    fields = pathlib.Path(f'/proc/{process.pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


@dataclasses.dataclass
class Run:
    """What a run gave. A code below 0 is the signal that ended it."""
    arguments: list
    code: int
    out: bytes
    err: bytes
    seconds: float
    peak: int  # bytes of memory held at most

    def tell(self):
        err = self.err[-1500:].decode(errors='backslashreplace')
        line = ' '.join(a if len(a) < 80 else a[:77] + '...' for a in map(str, self.arguments))
        return f'  $ {line}\n  code {self.code}, {self.seconds:.1f} s, {self.peak >> 20} MiB\n  {err}'


class Place:
    """A folder of its own for one attack, and the command under test."""

    def __init__(self, command, folder, sanitized):
        self.command, self.folder, self.sanitized = str(command), pathlib.Path(folder), sanitized

    def file(self, name, content=b''):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    def box(self, name='box.obj'):
        """A cube of side 1."""
        return self.file(name, BOX)

    def names(self):
        """Everything in the folder, temporary files as well."""
        return sorted(str(p.relative_to(self.folder)) for p in self.folder.rglob('*'))

    def start(self, *arguments, limits=(), before=None, **more):
        """A run under way. `limits` are pairs for resource.setrlimit; `before` is called in the child."""
        def prepare():
            for what, value in limits:
                resource.setrlimit(what, (value, value))
            if before:
                before()
        return subprocess.Popen([self.command, *map(str, arguments)], cwd=self.folder, preexec_fn=prepare,
                                **{'stdin': subprocess.DEVNULL, 'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE, **more})

    def longer(self, seconds):
        return seconds * (SANITIZED_FACTOR if self.sanitized else 1)

    def end(self, process, by):
        """Sends a signal to a run, which has to end at once, by it or by itself."""
        before = processor_seconds() + processor_seconds_so_far(process)
        process.send_signal(by)
        try:
            process.communicate(timeout=self.longer(SOON))
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Failed(f'{by.name}: not ended after {self.longer(SOON)} s') from None
        worked = processor_seconds() - before
        self.check(worked < self.longer(SOON_PROCESSOR_SECONDS), f'{by.name}: took {worked:.1f} s of processors\' time to end')

    def run(self, *arguments, input=None, **more):
        """Runs the command to its end, which has to come in time."""
        most, before = self.longer(MOST_SECONDS), processor_seconds()
        if input is not None:
            more['stdin'] = subprocess.PIPE
        began = time.monotonic()
        process = self.start(*arguments, **more)
        try:
            out, err = process.communicate(input, timeout=most)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Failed(f'not ended after {most} s\n  $ ' + ' '.join(map(str, arguments))[:300]) from None
        worked = processor_seconds() - before
        if worked > self.longer(MOST_PROCESSOR_SECONDS):
            raise Failed(f'took {worked:.1f} s of processors\' time\n  $ ' + ' '.join(map(str, arguments))[:300])
        # Of all children so far; as each attack has a process of its own, of this run or one before it.
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
        return Run(list(arguments), process.returncode, out or b'', err or b'', time.monotonic() - began, peak)

    def check(self, condition, why, run=None):
        if not condition:
            raise Failed(why + ('\n' + run.tell() if run else ''))

    def ended_well(self, run, code):
        """With this code, no signal, and nothing that a sanitizer or the C++ runtime says."""
        self.check(run.code == code, f'expected exit code {code}', run)
        bad = re.search(rb'AddressSanitizer|LeakSanitizer|runtime error:|terminate called|Assertion', run.err)
        self.check(not bad, 'expected no fault', run)

    def refused(self, run, code, says=''):
        """One message on one line, of a length that can be read, that says what it is about (a regular expression)."""
        self.ended_well(run, code)
        lines = run.err.decode(errors='backslashreplace').splitlines()
        self.check(len(lines) == 1, 'expected a message of one line', run)
        self.check(len(lines[0]) <= LONGEST_LINE, f'expected a line of at most {LONGEST_LINE} characters', run)
        self.check(re.search(says, lines[0]), f'expected a message that says {says!r}', run)


BOX = ('v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n'
       'f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n')
