# SPDX-License-Identifier: Apache-2.0
"""Standard streams that are closed or full, and no threads or memory to be had."""
import os
import resource

from attack import attack, attack_each

BAD = 'none.obj o.obj -d 0.1'.split()


def closed(*numbers):
    def close():
        for number in numbers:
            os.close(number)
    return close


def full(place, number):
    file = open('/dev/full', 'wb')
    return {'stdout' if number == 1 else 'stderr': file}


ERRORS = {
    'usage': (1, '--nonsense'.split()), 'no arguments': (1, []), 'no input': (2, BAD),
    'input is a folder': (2, '. o.obj -d 0.1 --format obj'.split()),
    'refused': (3, 'box.obj o.obj -d 0.1 --voxel-size 1e-9'.split()),
    'no folder': (4, 'box.obj no/o.obj -d 0.1'.split()),
    'check': (2, 'check none.obj box.obj'.split()),
    'warnings': (0, 'box.obj o.off -d 0.1 --normals recompute'.split()),
    'summary': (0, 'box.obj - --format obj -d 0.1'.split()),
    'strict': (3, 'scene.json o.obj --strict'.split()),
}
SHORT = ('{"shape": {"type": "icosphere", "radius": 1, "subdivisions": 2}, "offset": {"distance": 0.1}, '
         '"expect": {"max_reached": 0.5}}')


@attack_each(ERRORS)
def no_place_for_a_message(place, case):
    code, arguments = case
    place.box()
    place.file('scene.json', SHORT)
    place.ended_well(place.run(*arguments, **full(place, 2)), code)
    place.ended_well(place.run(*arguments, stderr=None, stdin=None, before=closed(0, 2)), code)


PRINTED = {
    'help': '--help', 'version': '--version', 'check help': 'check --help', 'plan': 'box.obj o.obj -d 0.1 --dry-run',
    'plan of a surface': 'box.obj o.obj -d 0.1 --mode iso --dry-run', 'check': 'check box.obj box.obj',
    'view': 'view box.obj --no-open --html p.html', 'page': 'view box.obj box.obj --html -', 'view help': 'view --help',
    'plan of layers': 'box.obj o.vtu --layers 2 --first-height 0.1 --dry-run',
    'check as JSON': 'check box.obj box.obj --json', 'report': 'box.obj o.obj -d 0.1 --report -',
    'mesh': 'box.obj - --format obj -d 0.1', 'compressed': 'box.obj - --format ply -d 0.1',
    'summary': 'box.obj o.obj -d 0.1', 'summary of layers': 'box.obj o.vtu --layers 2 --first-height 0.1',
}


@attack_each(PRINTED)
def no_place_for_output(place, line):
    place.box()
    place.refused(place.run(*line.split(), **full(place, 1)), 4, 'standard output: cannot be written: No space left')
    place.refused(place.run(*line.split(), stdout=None, before=closed(1)), 4, 'standard output: cannot be written')


@attack_each({'help': '--help', 'mesh': 'box.obj - --format obj -d 0.1', 'plan': 'box.obj o.obj -d 0.1 --dry-run'})
def reader_that_has_gone(place, line):
    place.box()
    reader, writer = os.pipe()
    os.close(reader)
    try:
        place.refused(place.run(*line.split(), stdout=writer), 4, 'standard output: cannot be written: Broken pipe')
    finally:
        os.close(writer)


@attack
def no_message_in_a_file(place):
    """With all streams closed, the first file that is opened must not become one of them."""
    place.box()
    place.file('warned.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n')
    for streams in ((0,), (1,), (2,), (1, 2), (0, 1, 2)):
        none = {('stdin', 'stdout', 'stderr')[n]: None for n in streams}
        run = place.run('warned.obj', 'o.obj', '-d', '0.1', '--report', 'r.json', **none, before=closed(*streams))
        place.ended_well(run, 4 if 1 in streams else 0)
        place.check((place.folder / 'o.obj').read_bytes().startswith(b'v '), 'expected a mesh and nothing else', run)
        place.check((place.folder / 'r.json').read_bytes().startswith(b'{'), 'expected a report and nothing else', run)


@attack
def closed_input(place):
    place.refused(place.run('-', 'o.obj', '--format', 'obj', '-d', '0.1', stdin=None, before=closed(0)), 2,
                  'standard input')


def as_nobody():
    """Limits of processes do not bind root."""
    os.setgroups([])
    os.setgid(65534)
    os.setuid(65534)


@attack_each({'none': 0, 'one': 1, 'two': 2, 'five': 5})
def no_threads(place, most):
    if place.sanitized:
        return  # the sanitizers need threads of their own
    place.box()
    place.folder.chmod(0o777)
    before = as_nobody if os.getuid() == 0 else None
    if before and not reachable_by_nobody(place.command):
        return
    try:
        run = place.run('box.obj', 'o.obj', '-d', '0.1', limits=[(resource.RLIMIT_NPROC, most)], before=before)
    except BlockingIOError:
        return  # another of these attacks runs as the same user, so that the system does not even start this one
    if most >= 2 and run.code == 0:
        return  # a machine on which that is enough
    place.refused(run, 3, 'thread')
    place.check(place.names() == ['box.obj'], 'expected no file', run)


def reachable_by_nobody(path):
    while path != '/':
        if not os.stat(path).st_mode & 0o1:
            return False
        path = os.path.dirname(path)
    return True


@attack_each({f'{m} MiB': m for m in (120, 130, 140, 145, 150, 155, 160, 165, 170)})
def no_memory(place, mebibytes):
    if place.sanitized:
        return  # whose shadow memory is larger than any limit
    place.box()
    run = place.run('box.obj', 'o.obj', '-d', '0.1', '--report', 'r.json', limits=[(resource.RLIMIT_AS, mebibytes << 20)])
    if run.code == 0 or run.code == 127:  # enough, or too little for the loader of shared libraries
        place.check(run.code == 0 or b'shared libraries' in run.err, 'expected the loader to refuse', run)
        return
    place.refused(run, 3, 'memory|thread')
    place.check(place.names() == ['box.obj'], 'expected no file', run)


@attack_each({'four files': (resource.RLIMIT_NOFILE, 4), '20 MiB of data': (resource.RLIMIT_DATA, 20 << 20),
              '40 MiB of data': (resource.RLIMIT_DATA, 40 << 20)})
def no_more(place, limit):
    if place.sanitized:
        return
    place.box()
    run = place.run('box.obj', 'o.obj', '-d', '0.1', '--save-vdb', 'v.vdb', limits=[limit])
    if run.code not in (0, 127):
        place.refused(run, 4 if limit[0] == resource.RLIMIT_NOFILE else 3, 'Too many open files|memory|thread')
        place.check(place.names() == ['box.obj'], 'expected no file', run)
