# SPDX-License-Identifier: Apache-2.0
"""OBJ files that are cut, lie, or are something else."""
from hostile import HUGE, OBJ, OBJ_FACES, OBJ_VERTICES, STL, STL_TEXT, attack_files, gzipped

END = 'the end of the (file|line)'


def face(text):
    """A mesh whose last face, in line 9, is wrong."""
    return OBJ + f'f {text}\n'


NUMBERS = {name: (f'v 0 0 0\nv 1 {name} 0\n' + OBJ_FACES, 'line 2', 'a coordinate', '') for name in (
    'nan', '-infinity', '1e999', '1e99999999999999999999', '0x10', '1.0.0', '+-1', '1e', '1\0')}
INDICES = {f'index {text}': (face(f'1 2 {text}'), 'line 9', expected, text[:20].replace('\0', '.')) for text, expected in {
    '0': 'from 1 on', '5': 'up to 4', '-5': 'within the 4', '2147483648': 'up to 4', '4294967297': 'up to 4',
    str(HUGE['2^63']): 'a vertex index', str(HUGE['-2^63'] - 1): 'a vertex index',
    '9' * 400: 'a vertex index', '1e0': 'a vertex index', 
    '/1': 'a vertex index', '1/x': 'a texture index', '1//x': 'a normal index', '1/1/1/1': 'of the form'}.items()}
NORMALS = {f'normal {text}': ('vn 0 0 1\n' + face(f'1 2 3//{text}'), 'line 10', 'a normal index', '') for text in ('2', '-2')}

FILES = {
    'empty': ('', 'byte 0', 'a mesh', 'an empty file'),
    'only comments': ('# nothing\n' * 100, 'line 101', 'at least one face', ''),
    'no face': (OBJ_VERTICES, 'line 5', 'at least one face', ''),
    'cut in a vertex': (OBJ + 'v 0 0', 'line 9', 'a coordinate', END),
    'cut in a face': (OBJ + 'f 1 2', 'line 9', 'at least 3 corners', '2'),
    'cut in a corner': (OBJ + 'f 1 2 3/x', 'line 9', 'a texture index', 'x'),
    'cut in a normal': (OBJ + 'vn 0 0', 'line 9', 'three numbers of a normal', END),
    'face of two': (OBJ + 'f 1 2\n', 'line 9', 'at least 3 corners', '2'),
    'a repeated corner': (OBJ + 'f 1 1 2\n', 4),
    'all corners repeated': (OBJ_VERTICES + 'f 1 1 1\n', None, 'expected a face with an area'),
    'a number of 400 digits': ('v 0 0 0\nv 1 ' + '1' * 400 + ' 0\n' + OBJ_FACES, 'line 2', 'of at most 330', 'of 400'),
    'coordinates whose square is no number': (OBJ.replace('v 1 0 0', 'v 1e200 0 0'), None,
                                              'expected a bounding box with a finite diagonal'),
    'a line continued by the end': (OBJ + 'f 1 2 3 \\', 'line 9', 'a vertex index', ''),
    'a keyword continued': (OBJ + '\\\nf 1 2 \\\r\n 3\n', 4),
    'a mark of byte order': (b'\xef\xbb\xbf' + OBJ.encode(), 4),
    'lines that end in CR': (OBJ.replace('\n', '\r'), 4),
    'lines of both kinds': (OBJ_VERTICES.replace('\n', '\r\n') + OBJ_FACES, 4),
    'a name of 1 MiB': ('g ' + 'x' * (1 << 20) + '\n' + OBJ, 4),
    'a keyword of 1 MiB': ('x' * (1 << 20) + '\n' + OBJ, 'line 1', 'a line of an OBJ file', r"'x{24}\.\.\.'"),
    'a coordinate of 1 MiB': ('v 0 0 ' + '0' * (1 << 20) + '\n' + OBJ, 'line 1', 'of at most 330', 'of 1048576'),
    'an index of 1 MiB': (face('1 2 ' + '9' * (1 << 20)), 'line 9', 'a vertex index', r"'9{24}\.\.\.'"),
    'UTF-16 with its mark': (OBJ.encode('utf-16'), 'line 1', 'a line of an OBJ file', ''),
    'zeros': (bytes(1000), 'line 1', 'a line of an OBJ file', r"'\?+\.\.\.'"),
    'bytes of all kinds': (bytes(range(256)) * 16, 'line [12]', 'a line of an OBJ file', ''),
    'a PNG': (b'\x89PNG\r\n\x1a\n' + bytes(100), 'line 1', 'a line of an OBJ file', ''),
    'an STL file': (STL_TEXT, 'line 31', 'at least one face', ''),
    'a binary STL file': (STL, 'line 1', 'a line of an OBJ file', ''),
    'gzip': (gzipped(OBJ), 'line 1', 'a line of an OBJ file', ''),
}

for kind, cases in {'number': NUMBERS, 'index': INDICES, 'normal': NORMALS, 'file': FILES}.items():
    attack_files(__name__, kind, 'obj', cases)
