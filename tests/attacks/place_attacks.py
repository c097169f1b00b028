# SPDX-License-Identifier: Apache-2.0
"""What stands where a file is expected: folders, devices, pipes, links, and files that may not be read."""
import os
import signal
import time

from attack import MOST_SECONDS, attack, attack_each
from hostile import OBJ, refused

ROLES = {
    'input': ('{}', 'out.obj', '-d', '0.1'),
    'scene': ('{}', 'out.obj'),
    'distances': ('mesh.obj', 'out.obj', '--distance-from', '{}'),
    'heights': ('mesh.obj', 'out.vtu', '--heights', '{}'),
    'faces': ('mesh.obj', 'out.obj', '-d', '0.1', '--only', 'faces={}'),
    'obstacle': ('mesh.obj', 'out.obj', '-d', '0.1', '--obstacle', '{}'),
    'check': ('check', 'mesh.obj', '{}'),
    'view': ('view', '{}', '--no-open', '--html', 'page.html'),
    'view result': ('view', 'mesh.obj', '{}', '--no-open', '--html', 'page.html'),
}
ENDINGS = {'scene': 'json', 'distances': 'txt', 'heights': 'txt', 'faces': 'txt'}


def arguments_of(role, name):
    return [a.format(name) for a in ROLES[role]]


def name_in(role):
    return f'odd.{ENDINGS.get(role, "obj")}'


def tried(place, role, message, code=2):
    """With what stands there already."""
    place.file('mesh.obj', OBJ)
    before = place.names()
    run = place.run(*arguments_of(role, name_in(role)))
    place.refused(run, code, message)
    place.check(place.names() == before, f'expected no file: {place.names()}', run)


each_role = attack_each({role: role for role in ROLES})


@each_role
def folder(place, role):
    (place.folder / name_in(role)).mkdir()
    tried(place, role, rf'odd\.{ENDINGS.get(role, "obj")}: (expected a file, got a folder|cannot be read)')


@each_role
def missing(place, role):
    tried(place, role, rf'odd\.{ENDINGS.get(role, "obj")}: cannot be (opened|read)')


@attack
def link_to_itself(place):
    os.symlink('odd.obj', place.folder / 'odd.obj')
    tried(place, 'input', 'odd.obj: cannot be opened: Too many levels')


@attack
def behind_a_file(place):
    place.file('mesh.obj', OBJ)
    refused(place, 'file', '', 'cannot be opened: Not a directory', 'file/mesh.obj', 'out.obj', '-d', '0.1')


@attack
def unreadable(place):
    place.file('odd.obj', OBJ).chmod(0)
    if not os.access(place.folder / 'odd.obj', os.R_OK):
        tried(place, 'input', 'odd.obj: cannot be opened: Permission denied')


@attack
def devices(place):
    """One that has nothing, one that fails, and standard input that has nothing or is a folder."""
    os.symlink('/dev/null', place.folder / 'odd.obj')
    tried(place, 'input', 'odd.obj, byte 0: expected a mesh, got an empty file')
    os.remove(place.folder / 'odd.obj')
    os.symlink('/proc/self/mem', place.folder / 'odd.obj')
    tried(place, 'input', 'odd.obj: cannot be read|expected a mesh, got an empty file')
    place.refused(place.run('-', 'out.obj', '-d', '0.1', '--format', 'obj'), 2, 'expected a mesh, got an empty file')
    here = os.open(place.folder, os.O_RDONLY)
    place.refused(place.run('-', 'out.obj', '-d', '0.1', '--format', 'obj', stdin=here), 2, 'standard input: cannot be read')
    os.close(here)


@attack
def pipe_that_is_cut(place):
    """Its writer goes away in the middle of a line."""
    os.mkfifo(place.folder / 'odd.obj')
    process = place.start('odd.obj', 'out.obj', '-d', '0.1')
    with open(place.folder / 'odd.obj', 'wb') as pipe:
        pipe.write(OBJ.encode() + b'f 1 2')
    out, err = process.communicate(timeout=place.longer(MOST_SECONDS))
    place.check(process.returncode == 2 and b'line 9: expected at least 3 corners' in err, f'expected a refusal: {err}')
    place.check(place.names() == ['odd.obj'], f'expected no file: {place.names()}')


@each_role
def pipe_without_a_writer(place, role):
    """It waits, and ends by the signal that it gets."""
    place.file('mesh.obj', OBJ)
    os.mkfifo(place.folder / name_in(role))
    before = place.names()
    process = place.start(*arguments_of(role, name_in(role)))
    time.sleep(3 if place.sanitized else 0.5)
    place.check(process.poll() is None, 'expected it to wait')
    place.end(process, signal.SIGTERM)
    place.check(process.returncode == -signal.SIGTERM, f'expected the end by the signal, got {process.returncode}')
    place.check(place.names() == before, f'expected no file: {place.names()}')
