# SPDX-License-Identifier: Apache-2.0
"""Folders that others write to as well, and files that change under a run."""
import os
import signal
import threading
import time

import models
from attack import attack


@attack
def longest_names(place):
    """What the file system takes as a name is taken as one."""
    box = place.box()
    for name in ('n' * 251 + '.obj', 'n' * 248 + '.obj.gz', '😀' * 62 + '.stl'):
        place.ended_well(place.run(box, name, '-d', '0.1', '-q'), 0)
        place.check(place.names() == sorted(['box.obj', name]), f'got {place.names()}')
        (place.folder / name).unlink()
    place.refused(place.run(box, 'n' * 252 + '.obj', '-d', '0.1'), 4, 'File name too long')
    place.check(place.names() == ['box.obj'], f'got {place.names()}')


@attack
def links_that_lead_nowhere(place):
    """The file that a link names is made, and the link stays."""
    box = place.box()
    os.symlink('made.obj', place.folder / 'link.obj')
    place.ended_well(place.run(box, 'link.obj', '-d', '0.1', '-q'), 0)
    place.check((place.folder / 'link.obj').is_symlink(), 'expected the link to stay')
    place.check(place.names() == ['box.obj', 'link.obj', 'made.obj'], f'got {place.names()}')


@attack
def leftovers_go(place):
    """Of a run that was killed, beside an output that is new."""
    source = place.file('m.obj', models.sphere(300, 200))
    for i in range(40):
        process = place.start(source, 'o.obj', '-d', '1%', '-q')
        while process.poll() is None and not any(name.startswith('.') for name in place.names()):
            pass
        process.kill()
        process.communicate()
        if any(name.startswith('.') for name in place.names()):
            break
        (place.folder / 'o.obj').unlink(missing_ok=True)
    place.check(any(name.startswith('.') for name in place.names()), 'expected a run to leave something')
    place.ended_well(place.run(place.box(), 'other.obj', '-d', '0.1', '-q'), 0)
    place.check([name for name in place.names() if name.startswith('.')] == [], f'left {place.names()}')


@attack
def a_terminal_that_goes(place):
    """Its progress bar is of no use then, and no reason to end."""
    import pty
    source = place.file('m.obj', models.sphere(100, 80))
    master, terminal = pty.openpty()
    process = place.start(source, 'o.obj', '-d', '1%', stderr=terminal, stdout=terminal,
                          before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    os.close(terminal)
    os.close(master)
    process.communicate()
    place.check(process.returncode in (0, 4) and 'o.obj' in place.names(), f'exit {process.returncode}: {place.names()}')


@attack
def planted_names(place):
    """Names that were guessed: a pipe that nobody reads, a link to what must not be touched."""
    box, treasure = place.box(), place.file('treasure', 'mine')
    process = place.start(box, 'o.obj', '-d', '0.1', '-q')
    for name in ('.tmp-%d-0.obj' % process.pid, '.o.obj.tmp', 'o.obj~', 'o.obj.tmp', '.vdb_offset-%d.obj' % process.pid):
        try:
            os.symlink(treasure, place.folder / name)
        except FileExistsError:
            pass
    process.communicate()
    place.check(process.returncode == 0, f'exit {process.returncode}')
    place.check(treasure.read_text() == 'mine', 'expected the file to stay as it was')


@attack
def cut_short_while_it_is_read(place):
    """A mapped input that loses its end is told, by the run and by check, and nothing is written."""
    text = models.sphere(300, 200)
    for i in range(6):
        source, other = place.file('m.obj', text), place.file('n.obj', text)
        arguments = ['check', source, other] if i % 2 else [source, 'o.obj', '-d', '1%']
        process = place.start(*arguments)
        time.sleep(0.01 + 0.02 * i)
        os.truncate(other if i % 2 else source, 100)
        process.communicate()
        place.check(process.returncode in (0, 2, 3), f'{arguments[0]}: exit {process.returncode}')
        place.check(process.returncode != 2 or 'o.obj' not in place.names(), 'expected no output')


@attack
def a_folder_where_the_output_goes(place):
    """The last name cannot be replaced: the others stay as they were."""
    source = place.file('m.obj', models.sphere(300, 200))
    place.file('r.json', 'old')
    process = place.start(source, 'o.obj', '-d', '1%', '--report', 'r.json', '--states', 's.csv')
    made = threading.Timer(0.05, lambda: (place.folder / 'o.obj').mkdir())
    made.start()
    _, err = process.communicate()
    made.join()
    if process.returncode == 0:
        return  # it was faster
    place.check(process.returncode == 4, f'exit {process.returncode}: {err}')
    place.check((place.folder / 'r.json').read_text() == 'old', 'expected the old report')
    place.check(place.names() == ['m.obj', 'o.obj', 'r.json'], f'left {place.names()}')


@attack
def runs_into_one_folder(place):
    """Many at once do not harm each other's files."""
    box = place.box()
    runs = [place.start(box, f'o{i}.obj', '-d', '0.1', '-q') for i in range(12)]
    for process in runs:
        process.communicate()
        place.check(process.returncode == 0, f'exit {process.returncode}')
    place.check(place.names() == sorted(['box.obj'] + [f'o{i}.obj' for i in range(12)]), f'got {place.names()}')


@attack
def a_full_device(place):
    """What cannot be written in full is not put in place, whatever the format."""
    if os.geteuid() != 0:
        return
    place.file('m.obj', models.sphere(60, 40))
    import resource
    for name, more in (('o.obj', []), ('o.stl', []), ('o.vtu', ['--layers', '3', '--total-thickness', '2%']),
                       ('o.cgns', ['--layers', '3', '--total-thickness', '2%'])):
        arguments = ['m.obj', name, '-q', *(more or ['-d', '1%'])]
        # VTK does not free all of what it writes with where that fails.
        run = place.run(*arguments, limits=[(resource.RLIMIT_FSIZE, 20000)],
                        env={**os.environ, 'ASAN_OPTIONS': 'detect_leaks=0'})
        place.refused(run, 4, name)
        place.check(place.names() == ['m.obj'], f'left {place.names()}')
