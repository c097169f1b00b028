# SPDX-License-Identifier: Apache-2.0
"""STL files, as text and binary, that are cut, lie, or are something else."""
import struct

from hostile import FACES, HUGE, OBJ, STL, STL_TEXT, attack_files, gzipped, stl_facet

END = 'the end of the (file|line)'
LINES = STL_TEXT.splitlines()


def line(number, text):
    return '\n'.join(LINES[:number - 1] + [text] + LINES[number:]) + '\n'


TEXT = {
    'as it is': (STL_TEXT, 12),
    'no facet': ('solid x\nendsolid x\n', 'line 3', 'at least one facet', ''),
    'cut behind a facet': ('\n'.join(LINES[:8]) + '\n', 'line 9', "'facet' or 'endsolid'", END),
    **{f'cut in line {n}': ('\n'.join(LINES[:n - 1] + [LINES[n - 1][:at]]), f'line {n}', expected, '')
       for n, at, expected in ((2, 5, "'normal'"), (2, 14, 'three numbers of a normal'), (3, 5, "'loop'"),
                               (5, 8, 'a coordinate'),
                               (8, 5, "'endfacet'"))},
    'a facet of two': ('\n'.join(LINES[:4] + LINES[5:]), 'line 6', "'vertex'", "'endloop'"),
    'an endless normal': (line(2, 'facet normal inf nan 1e999'), 12),
    **{f'coordinate {x}': (line(4, f'vertex 0 {x} 0'), 'line 4', 'a coordinate', '')
       for x in ('nan', '1e999')},
    'four coordinates': (line(4, 'vertex 0 0 0 0'), 'line 4', 'the end of the line', "'0'"),
    'a number of 400 digits': (line(4, 'vertex 0 0 ' + '7' * 400), 'line 4', 'of at most 330', 'of 400'),
    'words behind the end': (STL_TEXT + 'more\n', 'line 31', "'solid'", "'more'"),
    'capitals': (STL_TEXT.upper(), 12),
    'lines that end in CR': (STL_TEXT.replace('\n', '\r'), 12),
    'a name of 1 MiB': (STL_TEXT.replace('x', 'x' * (1 << 20), 1), 12),
    'a word of 1 MiB': (line(2, 'x' * (1 << 20)), 'line 2', "'facet' or 'endsolid'", r"'x{24}\.\.\.'"),
    'a mark of byte order': (b'\xef\xbb\xbf' + STL_TEXT.encode(), 12),
}


def promising(facets):
    return STL[:80] + struct.pack('<I', facets) + STL[84:]


def with_coordinate(bits):
    return STL[:84 + 12] + struct.pack('<I', bits) + STL[84 + 16:]


BINARY = {
    'as it is': (STL, 12),
    'empty': (b'', 'byte 0', 'a mesh', 'an empty file'),
    **{f'cut at {n}': (STL[:n], 'byte 0', "'solid' or a binary STL header", f'{n} bytes') for n in (83,)},
    **{f'cut at {n}': (STL[:n], 'byte 80', '4 facets, which take 284 bytes', f'{n} bytes') for n in (84, 283)},
    'no facets, and bytes': (promising(0), 'byte 80', 'at least one facet', 'a count of 0'),
    **{f'{n} facets': (promising(n), 'byte 80', f'{n} facets', '284 bytes')
       for n in (HUGE['2^31'], 2**32 - 1, 85899346)},
    'fewer facets than there are': (promising(3), 9),
    'a header that says solid': (b'solid'.ljust(80) + STL[80:], 12),
    'a header that says solid, cut': ((b'solid'.ljust(80) + STL[80:])[:-1], 'line 1', "'facet' or 'endsolid'", ''),
    'not a number': (with_coordinate(0x7fc00000), 'byte 96', 'a finite coordinate', 'nan'),
    'endless': (with_coordinate(0xff800000), 'byte 96', 'a finite coordinate', '-inf'),
    'the largest of numbers': (with_coordinate(0x7f7fffff), None, 'expected'),
    'without area': (STL[:80] + struct.pack('<I', 1) + stl_facet((1, 1, 1)), None, 'expected a face with an area'),
    'an OBJ file': (OBJ, 'byte 0', "'solid' or a binary STL header", '64 bytes'),
    'bytes of all kinds': (bytes(range(256)) * 4, 'byte 80', 'facets, which take', '1024 bytes'),
}
assert len(FACES) == 4

attack_files(__name__, 'text', 'stl', TEXT)
attack_files(__name__, 'binary', 'stl', BINARY)
