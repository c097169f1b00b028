# SPDX-License-Identifier: Apache-2.0
"""Hostile files: how each is made, handed to the command, and what has to come of it."""
import re
import struct
import zlib

from attack import attack_each

MIB = 1 << 20
# What a run takes by itself, and, of a file that has been refused, by the byte at most.
MOST_AT_REST, MOST_BY_BYTE = 160 * MIB, 64

# Whole numbers that lie about a count or an index, by what they are called.
HUGE = {'2^31': 2**31, '2^32': 2**32, '2^63': 2**63, '2^64': 2**64, '-2^63': -2**63}

VERTICES = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))


def joined(rows, start='', add=0):
    return ''.join(start + ' '.join(str(x + add) for x in row) + '\n' for row in rows)


OBJ_VERTICES, OBJ_FACES = joined(VERTICES, 'v '), joined(FACES, 'f ', 1)
OBJ = OBJ_VERTICES + OBJ_FACES
OFF = 'OFF\n4 4 6\n' + joined(VERTICES) + joined((3, *f) for f in FACES)


def stl_facet(corners):
    return struct.pack('<12fH', 0, 0, 0, *(float(x) for c in corners for x in VERTICES[c]), 0)


STL = bytes(80) + struct.pack('<I', 4) + b''.join(map(stl_facet, FACES))
STL_TEXT = 'solid x\n' + ''.join(
    'facet normal 0 0 0\nouter loop\n' + joined((VERTICES[c] for c in f), 'vertex ') + 'endloop\nendfacet\n' for f in FACES
) + 'endsolid x\n'


def as_bytes(content):
    return content.encode() if isinstance(content, str) else content


def says(name, where='', expected='', found=''):
    """What a message about a file looks like: NAME, WHERE: expected EXPECTED, got FOUND. All but the name are regular
    expressions."""
    where = f', (?:{where})' if where else ''
    return f'^vdb_offset: {re.escape(name)}{where}: expected .*(?:{expected}).*, (?:got|found|not) .*(?:{found})'


def refused(place, name, content, expected, *arguments, code=2):
    """A file, as it is read, is refused by one message, a regular expression, with nothing left behind, in memory of a
    small multiple of the file. `arguments` are all of the command line, if it is not the plainest one."""
    content = as_bytes(content)
    place.file(name, content)
    before = place.names()
    run = place.run(*(arguments or (name, 'out.obj', '-d', '0.1')))
    place.refused(run, code, expected)
    place.check(place.names() == before, f'expected no file, neither an output nor a temporary one: {place.names()}')
    if not place.sanitized:
        place.check(run.peak <= MOST_AT_REST + MOST_BY_BYTE * len(content), 'expected less memory', run)


def accepted(place, name, content, vertices):
    """A file that is odd, and read: the command has so many vertices from it."""
    place.file(name, as_bytes(content))
    run = place.run(name, 'out.obj', '-d', '0.1')
    place.ended_well(run, 0)
    told = re.search(rf'% of {vertices} (vertices|points) reached', run.out.decode())
    place.check(told, f'expected {vertices} vertices, or points', run)
    place.check((place.folder / 'out.obj').exists(), 'expected an output', run)


def attack_files(module, kind, ending, cases):
    """Each of `cases` is an attack of that module: (content, where, expected, found), which has to be refused, or
    (content, None, message), likewise, or (content, vertices), which has to be read."""
    name = f'hostile.{ending}'

    def check(place, case):
        if len(case) == 2:
            accepted(place, name, *case)
        else:
            refused(place, name, case[0], case[2] if case[1] is None else says(name, *case[1:]))
    check.__module__, check.__name__ = module, kind
    attack_each(cases)(check)


def gzipped(content, level=9):
    packer = zlib.compressobj(level, zlib.DEFLATED, 31)
    return packer.compress(as_bytes(content)) + packer.flush()
