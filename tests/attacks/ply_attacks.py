# SPDX-License-Identifier: Apache-2.0
"""PLY files, as text and binary of both orders, that are cut, lie, or are something else."""
import struct

from hostile import FACES, HUGE, OBJ, VERTICES, attack_files, gzipped, joined

END = 'the end of the (file|line)'


def header(vertices=4, faces=4, format='ascii 1.0', xyz='float', list='list uchar int vertex_indices', more='', face='face'):
    properties = ''.join(f'property {xyz} {k}\n' for k in 'xyz')
    return (f'ply\nformat {format}\nelement vertex {vertices}\n{properties}{more}'
            f'element {face} {faces}\nproperty {list}\nend_header\n')


HEAD = header()
VERTEX_ROWS, FACE_ROWS = joined(VERTICES), joined((3, *f) for f in FACES)
BODY = VERTEX_ROWS + FACE_ROWS
PLY = HEAD + BODY
FIRST = HEAD.count('\n') + 1  # line of the first vertex


def without(line):
    return HEAD.replace(line + '\n', '', 1) + BODY


def row(number, text):
    """With another line in the place of the one so numbered, of those behind the header."""
    lines = BODY.splitlines()
    lines[number] = text
    return HEAD + '\n'.join(lines) + '\n'


def swapped(old, new):
    assert old in HEAD
    return HEAD.replace(old, new, 1) + BODY


LINES = HEAD.splitlines()
HEADERS = {
    'as it is': (PLY, 4),
    'empty': ('', 'byte 0', 'a mesh', 'an empty file'),
    **{f'cut behind line {n}': ('\n'.join(LINES[:n]), f'line {n}', "a header line or 'end_header'", END) for n in (2, 8)},
    'no format': (without('format ascii 1.0'), 'line 8', "a 'format' line", ''),
    'an unknown format': (swapped('ascii', 'binary_middle_endian'), 'line 2', 'ascii, binary_little_endian',
                          "'binary_middle_endian'"),
    'no vertices': (HEAD.replace('vertex 4', 'point 4') + BODY, 'header', "an element 'vertex'", 'none'),
    'no list of corners': (swapped('vertex_indices', 'corners'), 'header', "a list 'vertex_indices'", 'none'),
    'a length by fractions': (swapped('list uchar', 'list float'), 'line 8', 'an integer type', ''),
    'no z': (without('property float z'), 'header', 'vertex properties x, y and z', ''),
    'x twice': (swapped('float y', 'float x'), 'header', 'each coordinate once', ''),
    'vertices twice': (HEAD.replace('element face', 'element vertex 0\nelement face') + BODY, 'header', 'each element once',
                       ''),
    'an unknown type': (swapped('float x', 'real x'), 'line 4', 'a PLY type', "'real'"),
    'no name': (swapped('property float x', 'property float'), 'line 4', 'the name of a property', ''),
    'an unknown line': (swapped('format', 'encoding x\nformat'), 'line 2', 'a header line', "'encoding'"),
    **{f'{n} vertices': (header(vertices=n) + BODY, 'line 3', "a number of 'vertex'|a number of elements", '')
       for n in (-1, HUGE['2^32'], HUGE['2^63'])},
    **{f'{n} faces': (header(faces=n) + BODY, 'line 7', "a number of 'face'", '') for n in (-1, HUGE['2^31'])},
    '0 vertices': (header(vertices=0) + FACE_ROWS, 'face 0', 'vertex indices below 0', ''),
    '0 faces': (header(faces=0) + VERTEX_ROWS, 'header', 'at least one face', ''),
    'a comment of 1 MiB': (swapped('format', 'comment ' + 'x' * (1 << 20) + '\nformat'), 4),
    'a keyword of 1 MiB': (swapped('format', 'x' * (1 << 20) + '\nformat'), 'line 2', 'a header line', r"'x{24}\.\.\.'"),
    '10,000 properties': (HEAD.replace('element face',
                                       ''.join(f'property int p{i}\n' for i in range(10000)) + 'element face') + ''.join(
        line + ' 0' * 10000 + '\n' for line in VERTEX_ROWS.splitlines()) + FACE_ROWS, 4),
    'lines that end in CR': (PLY.replace('\n', '\r'), 4),
    'a header that ends in CRLF': (HEAD.replace('\n', '\r\n') + BODY, 4),
    'UTF-16': (PLY.encode('utf-16'), 'line 1', 'the keyword ply', ''),
}

TEXT = {
    'no body': (HEAD, f'line {FIRST}', 'a coordinate', END),
    'vertices cut': (HEAD + '0 0 0\n1 0 0\n', f'line {FIRST + 2}', 'a coordinate', END),
    'faces cut': (HEAD + VERTEX_ROWS + '3 0 2 1\n', f'line {FIRST + 5}', "the number of a face's corners", END),
    'a face cut': (HEAD + VERTEX_ROWS + '3 0 2 1\n3 0', f'line {FIRST + 5}', 'a vertex index', END),
    **{f'coordinate {x}': (row(1, f'{x} 0 0'), f'line {FIRST + 1}', 'a coordinate|a finite coordinate', '')
       for x in ('nan', '1e39', '1' * 400)},
    **{f'a face of {n}': (row(4, f'{n} 0 1 2'), f'line {FIRST + 4}', 'at least 3 corners|corners', '')
       for n in ('2', '-3', '3.0')},
    **{f'a face of {n}': (row(7, f'{n} 0 1 2'), f'line (?:{FIRST + 7}|{FIRST + 8})', 'corners|a vertex index', '')
       for n in (HUGE['2^32'], HUGE['2^63'])},
    **{f'index {x}': (row(4, f'3 0 1 {x}'), f'(line {FIRST + 4}|face 0)', 'vertex ind', '')
       for x in ('4', '-1', '4294967295', '4294967296')},
    'one face without an end of its line': (header(faces=1) + VERTEX_ROWS + '3 0 1 2', 3),
}


def packed(order, format, vertices=4, faces=4, rows=None, face_rows=None, **more):
    rows = [struct.pack(order + '3f', *v) for v in VERTICES] if rows is None else rows
    face_rows = [struct.pack(order + 'B3i', 3, *f) for f in FACES] if face_rows is None else face_rows
    return header(vertices, faces, format, **more).encode() + b''.join(rows + face_rows)


def binary_cases(order, format):
    def made(**more):
        return packed(order, format, **more)

    def face(bytes_):
        return made(face_rows=[struct.pack(order + 'B3i', 3, *f) for f in FACES[:3]] + [bytes_])

    def good_body(**more):
        return made(**more).index(b'end_header\n') + 11

    good = made()
    body = good_body()
    last = body + 48 + 3 * 13
    return {
        'as it is': (good, 4),
        'no body': (good[:body], f'byte {body}', 'a coordinate', END),
        'a face cut': (good[:last + 7], f'byte {last + 5}', 'a vertex index', END),
        'bytes behind the last': (good + b'more', 4),
        'not a number': (made(rows=[struct.pack(order + '3f', 0, float('nan'), 0)] * 4), f'byte {body + 4}',
                         'a finite coordinate', 'nan'),
        **{f'a face of {n}': (face(struct.pack(order + 'B3i', n, 0, 1, 2)), f'byte {last}', 'at least 3 corners',
                              str(n)) for n in (2,)},
        'a face of 255': (face(struct.pack(order + 'B3i', 255, 0, 1, 2)), f'byte {last + 13}', 'a vertex index', END),
        'index 4': (face(struct.pack(order + 'B3i', 3, 0, 1, 4)), 'face 3', 'vertex indices below 4', '4'),
        'index -1': (face(struct.pack(order + 'B3i', 3, 0, 1, -1)), f'byte {last + 9}', 'a vertex index', '-1'),
        'a length below 0': (made(list='list int int vertex_indices', face_rows=[struct.pack(order + '4i', -3, 0, 1, 2)] * 4),
                             f'byte {good_body(list="list int int vertex_indices") + 48}', 'at least 3 corners', '-3'),
        'a length of 2^32 - 1': (made(list='list uint int vertex_indices',
                                      face_rows=[struct.pack(order + 'I3i', 2**32 - 1, 0, 1, 2)] * 4),
                                 r'byte \d+', 'a vertex index', ''),
        'another list of 2^32 - 1': (made(more='property list uint double weights\n',
                                          rows=[struct.pack(order + '3fI', *v, 2**32 - 1) for v in VERTICES]),
                                     r'byte \d+', 'an item of a list', END),
    }


def strips(*rows, type='int'):
    return header(4, len(rows), list=f'list int {type} vertex_indices', face='tristrips') + VERTEX_ROWS + ''.join(
        f'{len(row)} ' + ' '.join(map(str, row)) + '\n' for row in rows)


LINE = FIRST + 4
STRIPS = {
    'as they are': (strips((0, 1, 2, -1, 0, 1, 3, 2)), 4),
    'too short for a triangle': (strips((0, 1, -1, 2, 3, -1, -1)), 'header', 'at least one face', ''),
    'cut': (strips((0, 1, 2))[:-3], f'line {LINE}', 'a vertex index or -1', END),
    'one row without an end': (strips((0, 1, 2))[:-1], 3),
    'index 4': (strips((0, 1, 4)), 'face 0', 'vertex indices below 4', '4'),
    'index 2^32': (strips((0, 1, 2**32)), f'line {LINE}|face 0', 'a vertex ind', ''),
    'a length below 0': (strips((0, 1, 2)).replace('\n3 0 1 2', '\n-3 0 1 2'), f'line {LINE}', 'a list length from 0', '-3'),
    'a length of 2^40': (strips((0, 1, 2)).replace('\n3 0 1 2', f'\n{2**40} 0 1 2'), f'line {LINE + 1}',
                         'a vertex index or -1', END),
    'ends without a sign': (strips((0, 1, 2, 255, 0, 1, 3), type='uchar'), 4),
}

attack_files(__name__, 'header', 'ply', HEADERS)
attack_files(__name__, 'text', 'ply', TEXT)
attack_files(__name__, 'little', 'ply', binary_cases('<', 'binary_little_endian 1.0'))
attack_files(__name__, 'big', 'ply', binary_cases('>', 'binary_big_endian 1.0'))
attack_files(__name__, 'strips', 'ply', STRIPS)
