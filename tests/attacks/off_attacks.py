# SPDX-License-Identifier: Apache-2.0
"""OFF files, as text and as Geomview's binary ones, that are cut, lie, or are something else."""
import struct

from hostile import FACES, HUGE, OBJ, OFF, VERTICES, attack_files, gzipped, joined

END = 'the end of the (file|line)'
ROWS = OFF.split('\n', 2)[2]


def counts(text):
    return f'OFF\n{text}\n{ROWS}'


def row(number, text):
    """With another line in the place of the one so numbered."""
    lines = OFF.splitlines()
    lines[number - 1] = text
    return '\n'.join(lines) + '\n'


HOLD = 'that the rest of the file'
TEXT = {
    'empty': ('', 'byte 0', 'a mesh', 'an empty file'),
    'only the keyword': ('OFF\n', 'line 2', 'a number of vertices', END),
    'no keyword': (OFF[4:], 'line 1', 'the keyword OFF', "'4'"),
    'four coordinates': ('4' + OFF, 'line 1', 'OFF with three coordinates', ''),
    'letters in another order': ('NC' + OFF, 'line 1', 'OFF with three coordinates', ''),
    'no vertices': ('OFF\n0 0 0\n', 'line 2', 'at least one face', ''),
    'no faces': ('OFF\n4 0 0\n' + joined(VERTICES), 'line 7', 'at least one face', ''),
    'a line for each number': (OFF.replace('4 4 6', '4\n4\n6'), 4),
    'more vertices than there are': (counts('5 4 6'), 'line 11', 'face 4 of 4', END),
    'more faces than there are': (counts('4 5 6'), 'line 11', 'face 5 of 5', END),
    'a vertex cut': (f'OFF\n4 0 0\n{joined(VERTICES)}'[:-3], 'line 6', 'a coordinate', END),
    'a vertex of two': (row(4, '1 0'), 'line 4', 'a coordinate', END),
    'faces cut': (OFF[:OFF.index('3 1 2 3')], 'line 9', 'face 3 of 4', END),
    'a face cut': (OFF[:OFF.index('3 1 2 3') + 4], 'line 9', 'a vertex index', END),
    'negative vertices': (counts('-4 4 6'), 'line 2', HOLD, "'-4'"),
    **{f'{name} {what}': (counts(text.format(number)), 'line 2', f'{HOLD}|a number of {what}', '')
       for name, number in list(HUGE.items())[1:3] for what, text in (('vertices', '{} 4 6'), ('faces', '4 {} 6'))},
    **{f'coordinate {x}': (row(4, f'{x} 0 0'), 'line 4', 'a coordinate', '') for x in ('nan', '1e999')},
    'a number of 400 digits': (row(4, '1' * 400 + ' 0 0'), 'line 4', 'of at most 330', 'of 400'),
    **{f'face {x}': (row(9, x), 'line 9', 'at least 3 corners', '') for x in ('2 0 1', '-3 0 1 2')},
    **{f'face of {name}': (row(9, f'{number} 0 1 2'), 'line 9', 'corners|a vertex index', '') for name,
       number in list(HUGE.items())[1:3]},
    **{f'index {x}': (row(9, f'3 0 1 {x}'), 'line 9', 'a vertex index', '')
       for x in ('4', '-1', '4294967296')},
    'normals promised': ('N' + OFF, 'line 3', 'three numbers of a normal', END),
    'colours promised': ('C' + OFF, 4),
    'lines that end in CR': (OFF.replace('\n', '\r'), 4),
    'UTF-16': (OFF.encode('utf-16'), 'line 1', 'the keyword OFF', ''),
    'a keyword of 1 MiB': ('x' * (1 << 20), 'line 1', 'the keyword OFF', r"'x{24}\.\.\.'"),
    'an OBJ file': (OBJ, 'line 1', 'the keyword OFF', "'v'"),
}


def binary(vertices=4, faces=4, edges=6, keyword='OFF', rows=None, face_rows=None):
    rows = [struct.pack('>3f', *v) for v in VERTICES] if rows is None else rows
    face_rows = [struct.pack('>5i', 3, *f, 0) for f in FACES] if face_rows is None else face_rows
    return f'{keyword} BINARY\n'.encode() + struct.pack('>3i', vertices, faces, edges) + b''.join(rows + face_rows)


GOOD = binary()
HEAD, ROW = len('OFF BINARY\n'), 12


def with_face(*words):
    return binary(face_rows=[struct.pack('>5i', 3, *f, 0) for f in FACES[:3]] + [struct.pack(f'>{len(words)}i', *words)])


LAST = HEAD + 12 + 4 * ROW + 3 * 20
BINARY = {
    'as it is': (GOOD, 4),
    **{f'cut {where}': (GOOD[:at], r'byte \d+', expected, found)
       for where, at, expected, found in (
           ('behind its line', HEAD, 'a number of vertices', 'the end of the file'),
           ('in the vertices', HEAD + 12 + 30, '4 vertices of 12 bytes|' + HOLD, ''),
           ('in a face', LAST + 4, 'as many corners|' + HOLD, ''),
           ('before a colour', LAST + 16, "a face's colour|" + HOLD, ''))},
    **{f'{n} {what}': (binary(**{what: n}), f'byte {HEAD + at}', HOLD, str(n))
       for n in (-1, 2**31 - 1) for what, at in (('vertices', 0), ('faces', 4))},
    'no faces': (binary(faces=0, face_rows=[]), r'byte \d+', 'at least one face', 'a count of 0'),
    'more vertices than there are': (binary(vertices=5), r'byte \d+', '', ''),
    'a coordinate that is not a number': (binary(rows=[struct.pack('>3f', float('nan'), 0, 0)] * 4), f'byte {HEAD + 12}',
                                          'a finite coordinate', 'nan'),
    **{f'face of {n}': (with_face(n, 0, 1, 2, 0), f'byte {LAST}', 'corners', str(n)) for n in (2, -1, 2**31 - 1)},
    **{f'index {n}': (with_face(3, 0, 1, n, 0), f'byte {LAST + 12}', 'a vertex index below 4', str(n)) for n in (4, -1)},
    **{f'{n} colours': (with_face(3, 0, 1, 2, n), f'byte {LAST + 16}' if n != 4 else f'byte {LAST + 20}', 'colour',
                        '') for n in (-1, 4)},
    'normals promised': (binary(keyword='NOFF'), r'byte \d+', '', ''),
    'colours promised': (binary(keyword='CNOFF'), r'byte \d+', '', ''),
}

attack_files(__name__, 'text', 'off', TEXT)
attack_files(__name__, 'binary', 'off', BINARY)
