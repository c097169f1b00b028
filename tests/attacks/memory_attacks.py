# SPDX-License-Identifier: Apache-2.0
"""Files that hold more than they look like, and runs that would: refused before they pass --max-memory."""
import gzip
import struct

from attack import BOX, attack, attack_each

MIB = 1 << 20
# What a run may hold beyond its limit or its estimate: the share that the project allows itself.
SLACK = 1.15


def held_to(place, run, limit):
    """Sanitizers hold many times as much."""
    if not place.sanitized:
        place.check(run.peak <= SLACK * limit, f'expected at most {limit >> 20} MiB, with {SLACK}', run)


def refused_within(place, limit, *arguments):
    run = place.run(*arguments, '--max-memory', f'{limit // MIB}M')
    place.refused(run, 3, '--max-memory')
    held_to(place, run, limit)


def bomb(place, name, line, count):
    """A cube behind `count` lines, compressed piece by piece: members of their own are a file as well."""
    piece = gzip.compress(line.encode() * 100000, 6)
    return place.file(name, gzip.compress(BOX.encode()) + piece * (count // 100000))


def zstd_bomb(place, name, size):
    """Comments of 128 KiB, each in a block of four bytes: one that repeats a byte."""
    def block(kind, length, content, last=False):
        return struct.pack('<I', last | kind << 1 | length << 3)[:3] + content
    comment = block(0, 3, b'\n##') + block(1, 1 << 17, b'#')
    frame = struct.pack('<IBB', 0xfd2fb528, 0, 0x58) + block(0, len(BOX), BOX.encode())  # a window of 2 MiB
    return place.file(name, frame + comment * (size >> 17) + block(0, 1, b'\n', last=True))


BOMBS = {
    'comments': ('bomb.obj.gz', '# nothing to be seen here\n', 12000000),
    'faces': ('bomb.obj.gz', 'f 1 2 3\n', 8000000),
    'vertices': ('bomb.obj.gz', 'v 0 0 0\n', 8000000),
}


@attack
def decompressed_zstd(place):
    """300 kB that hold 3 GB of comments."""
    bomb = zstd_bomb(place, 'bomb.obj.zst', 3 << 30)
    place.check(bomb.stat().st_size < 300000, f'{bomb.stat().st_size} bytes')
    refused_within(place, 500 * MIB, bomb, 'out.obj', '-d', '0.1')
    small = zstd_bomb(place, 'small.obj.zst', 1 << 20)
    place.ended_well(place.run(small, 'out.obj', '-d', '0.1'), 0)


# Options, the file's name, what it begins with, what is repeated in it how often, how it ends; the code, and the message.
ENDLESS = {
    'heights of one line': (['--layers', '3', '--heights', 'l.txt'], 'l.txt', b'', b'0', 60 << 20, b'', 2,
                            'l.txt: line 1: expected a height'),
    'heights that never end': (['--layers', '3', '--heights', '/dev/zero'], None, b'', b'', 0, b'', 3, '--max-memory'),
    'a list of faces': (['-d', '0.1', '--only', 'faces=f.txt'], 'f.txt', b'', b'0 ', 20 << 20, b'', 0, ''),
    'a scene': (['-d', '0.1'], 's.json', b'{"shape": [', b'1,', 10 << 20, b'1]}', 3, '--max-memory'),
    'a path of SVG': (['-d', '0.1'], 'p.svg', b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0', b' 1 1', 2 << 20,
                      b'"/></svg>', 3, '--max-memory'),
    'a path of curves': (['-d', '0.1'], 'p.svg', b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0t', b' 1 1 2 1', 64 << 10,
                         b'"/></svg>', 3, '--max-memory'),
    'a circle of more points than fit': (['-d', '0.1', '--flatten', '1e-15'], 'p.svg',
                                         b'<svg xmlns="http://www.w3.org/2000/svg"><circle r="1"/>', b'', 0, b'</svg>', 3,
                                         '--max-memory'),
}


@attack_each(ENDLESS)
def endless(place, case):
    """What is read beside a mesh, or in its place, keeps to the limit whatever it holds."""
    arguments, name, head, item, count, tail, code, says = case
    size = 0
    if name:
        with open(place.folder / name, 'wb') as file:  # by parts: what this process holds counts for those it starts
            file.write(head)
            for _ in range(count >> 10):
                file.write(item * 1024)
            size = file.write(tail) + file.tell()
    source = name if name and name[0] in 'sp' else place.box().name
    limit = 160 * MIB
    run = place.run(source, 'out.svg' if source == 'p.svg' else 'out.obj', *arguments, '-q', '--max-memory', f'{limit // MIB}M')
    if code:
        place.refused(run, code, says)
    else:
        place.ended_well(run, code)
    # The list itself is mapped: pages of the file, which the system may drop.
    held_to(place, run, limit + size)


@attack_each(BOMBS)
def decompressed(place, case):
    bomb(place, *case)
    refused_within(place, 150 * MIB, case[0], 'out.obj', '-d', '0.1')
    place.check(place.names() == [case[0]], 'expected no other file')


@attack
def many_faces(place):
    """Small as text, large as lists."""
    place.file('faces.obj', BOX + 'f 1 2 3\n' * 5000000)
    refused_within(place, 110 * MIB, 'faces.obj', 'out.obj', '-d', '0.1')


@attack
def off_from_a_pipe(place):
    text = 'OFF\n2000000 1 0\n' + '0 0 0\n' * 2000000 + '3 0 1 2\n'
    run = place.run('-', 'out.off', '--format', 'off', '-d', '0.1', '--max-memory', '100M', input=text.encode())
    place.refused(run, 3, '--max-memory')
    held_to(place, run, 100 * MIB)


SCENES = {
    'cube': '{"type": "cube", "side": 1, "divisions": 20000}',
    'icosphere': '{"type": "icosphere", "radius": 1, "subdivisions": 10}',
    'torus': '{"type": "torus", "major": 1, "minor": 0.3, "segments": 20000, "sides": 20000}',
    'gear': '{"type": "gear", "teeth": 20000, "root_radius": 1, "tip_radius": 1.1, "bore_radius": 0.5, "thickness": 0.2,'
            ' "stacks": 200}',
}


@attack_each(SCENES)
def scene(place, shape):
    place.file('scene.json', '{"shape": %s, "offset": {"distance": 0.1}}' % shape)
    refused_within(place, 200 * MIB, 'scene.json', 'out.obj')
    refused_within(place, 200 * MIB, 'scene.json', 'out.obj', '--dry-run')


@attack
def zigzag(place):
    """Each segment crosses about half of the others; what is near whom was a list as well, 25 times as long."""
    place.file('zigzag.txt', ''.join(f'{i * 1597 % 2584 / 258.4:.9g} {i % 2 * 10}\n' for i in range(2584)))
    limit = () if place.sanitized else ('--max-memory', '200M')
    run = place.run('zigzag.txt', 'out.txt', '-d', '0.05', *limit)
    place.ended_well(run, 0)
    place.check(b'more than 1000000 segment pairs' in run.err + run.out, 'expected to be told of them', run)
    held_to(place, run, 200 * MIB)
