# SPDX-License-Identifier: Apache-2.0
"""Files of numbers beside a mesh: distances, heights of layers, faces of a part; and the other meshes a run reads."""
import struct

from attack import attack, attack_each
from hostile import FACES, HUGE, OBJ, OFF, STL, VERTICES, joined, refused, says

GOOD = '0.1\n0.1\n0.2\n0.1\n'


def npy(shape='(4,)', type='<f8', order='False', version=1, header=None, numbers=struct.pack('<4d', .1, .1, .2, .1),
        length=None):
    header = f"{{'descr': '{type}', 'fortran_order': {order}, 'shape': {shape}, }}\n" if header is None else header
    size = struct.pack('<H' if version == 1 else '<I',
                       (len(header) if length is None else length) & (0xffff if version == 1 else 0xffffffff))
    return b'\x93NUMPY' + bytes([version, 0]) + size + header.encode() + numbers


def attack_beside(kind, name, cases, *arguments):
    """Files that stand beside a mesh of four vertices and faces. A case is (content, where, expected, found), or
    (content,), which has to be read."""
    def check(place, case):
        place.file('mesh.obj', OBJ)
        if len(case) > 1:
            message = case[2] if case[1] is None else says(name, *case[1:])
            refused(place, name, case[0], message, 'mesh.obj', 'out.obj', *arguments)
            return
        place.file(name, case[0])
        run = place.run('mesh.obj', 'out.obj', *arguments)
        place.ended_well(run, 0)
    check.__module__, check.__name__ = __name__, kind
    attack_each(cases)(check)


TEXT = {
    'as it is': (GOOD,),
    'empty': ('', None, 'expected 4 numbers, one for each vertex, found 0'),
    'too few': (GOOD[4:], None, 'expected 4 numbers, one for each vertex, found 3'),
    'too many': (GOOD + '0.1\n', None, 'expected 4 numbers, one for each vertex, found 5'),
    'a million too many': ('0.1\n' * 10**6, None, 'expected 4 numbers, one for each vertex, found 1000000'),
    **{f'number {x}': (f'0.1\n{x}\n0.1\n0.1\n', 'line 2', r'number.* for vertex 1 \(counted from 0\)', '')
       for x in ('nan', '1e999', '1%', '1' * 400)},
    'lines that end in CR': (GOOD.replace('\n', '\r'),),
    'UTF-16': (GOOD.encode('utf-16'), 'line 1', 'a number for vertex 0', ''),
    'a word of 1 MiB': ('x' * (1 << 20), 'line 1', 'a number of at most 330 characters for vertex 0', r'\.\.\.'),
    'so large that nothing is left': ('1e308\n' * 4, None, 'expected'),
}
NPY = {
    'as it is': (npy(),),
    'cut in the magic': (npy()[:5], 'byte 0', 'a NumPy array', ''),
    'cut in the length': (npy()[:9], 'byte 9', 'the length of the header', ''),
    'cut in the header': (npy()[:30], 'byte 10', 'a header of', 'the end of the file'),
    'cut in the numbers': (npy()[:-9], r'byte \d+', '4 numbers of 8 bytes', '23 bytes'),
    'bytes behind': (npy() + b'x', r'byte \d+', '4 numbers of 8 bytes', '33 bytes'),
    'an unknown version': (npy(version=9), 'byte 6', 'version 1, 2 or 3', 'version 9'),
    'a length beyond the file': (npy(version=2, length=2**32 - 1), 'byte 12', 'a header of', 'the end of the file'),
    'a length of 0': (npy(length=0), 'byte 10', "'{'", ''),
    **{f'shape {s}': (npy(shape=s), r'byte \d+', '', '') for s in ('()', '(4, 2)', '(-4,)', '(4', f'({2**64},)')},
    **{f'shape ({n},)': (npy(shape=f'({n},)'), None, f'expected 4 numbers, one for each vertex, found {n}')
       for n in (5, 2**64 - 1)},
    **{f'type {t}': (npy(type=t), r'byte \d+', 'numbers of the types', '') for t in ('<f2', '|O', '')},
    'a key twice': (npy(header="{'descr': '<f8', 'descr': '<f8'}"), r'byte \d+', 'each of the keys', ''),
    'no shape': (npy(header="{'descr': '<f8', 'fortran_order': False}"), r'byte \d+', "the keys 'descr'", ''),
    'a header of blanks': (npy(header=' ' * 60000), 'byte 60010', "'{'", 'the end'),
    'not a number': (npy(numbers=struct.pack('<4d', .1, float('nan'), .1, .1)), r'byte \d+', 'a finite number for vertex 1',
                     'nan'),
    'text': (GOOD, 'byte 0', 'a NumPy array', ''),
}
FACES_OF = {
    'as they are': ('0\n2\n',),
    'a mark for each': ('1 0 0 1\n',),
    'none': ('', None, 'expected'),
    **{f'face {x}': (f'0\n{x}\n', 'line 2', 'the index of a face', '') for x in ('4', '-1', HUGE['2^32'], HUGE['2^64'])},
    'marks that are too many': ('1 0 0 1 0\n',),
    'UTF-16': ('0\n1\n'.encode('utf-16'), 'line 1', 'the index of a face', ''),
}
HEIGHTS = {
    'as they are': ('0.01\n0.02\n',),
    'empty': ('', None, 'heights.txt: expected a height on each line, got none'),
    **{f'height {x[:20]}': (f'0.01\n{x}\n', None, r'heights.txt: line 2: ')
       for x in ('nan', '1e999', '@nothing', 'ply:x', '\0', '(' * 10000)},
    'on both sides': ('0.01\n-0.02\n', None, 'expected'),
    'a file of itself': ('@heights.txt\n', None, r'heights.txt: line 1: '),
}
LAYERS = ('--heights', 'heights.txt')
attack_beside('distances', 'distances.txt', TEXT, '--distance-from', 'distances.txt')
attack_beside('array', 'distances.npy', NPY, '--distance-from', 'distances.npy')
attack_beside('faces', 'faces.txt', FACES_OF, '-d', '0.1', '--only', 'faces=faces.txt')


@attack_each(HEIGHTS)
def heights(place, case):
    place.file('mesh.obj', OBJ)
    if len(case) > 1:
        refused(place, 'heights.txt', case[0], case[2], 'mesh.obj', 'out.vtu', *LAYERS)
        return
    place.file('heights.txt', case[0])
    place.ended_well(place.run('mesh.obj', 'out.vtu', *LAYERS), 0)


PROPERTY = ('ply\nformat {}\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n{}'
            'element face 4\nproperty list uchar int vertex_indices\nend_header\n')


@attack_each({
    'none': ('', '0', "expected a vertex property 'd'"),
    'a list': ('property list uchar int d\n', '0', "expected a vertex property 'd' of single numbers"),
    'twice': ('property float d\nproperty float d\n', '1 1', "expected one vertex property 'd', found several"),
    'not a number': ('property float d\n', 'nan', "line 1[0-9]: expected a finite number 'd' for vertex 0"),
    'a word': ('property int d\n', '1.5', "line 1[0-9]: expected a finite number 'd' for vertex 0"),
})
def vertex_property(place, case):
    properties, values, message = case
    rows = ''.join(line + (f' {values}' if properties else '') + '\n' for line in joined(VERTICES).splitlines())
    content = PROPERTY.format('ascii 1.0', properties) + rows + joined((3, *f) for f in FACES)
    refused(place, 'mesh.ply', content, message, 'mesh.ply', 'out.ply', '--distance-from', 'ply:d')


@attack
def second_meshes(place):
    """What `check`, `--obstacle` and `--fit` read is read like INPUT."""
    place.file('mesh.obj', OBJ)
    for name, content, message in (('bad.obj', OBJ + 'f 1 2 9\n', says('bad.obj', 'line 9', 'a vertex index up to 4', "'9'")),
                                   ('bad.off', OFF[:-3], says('bad.off', 'line 10', '', '')),
                                   ('bad.stl', STL[:-1], says('bad.stl', 'byte 80', '4 facets', '283'))):
        for arguments in (('check', 'mesh.obj', name), ('mesh.obj', 'out.obj', '-d', '0.1', '--obstacle', name),
                          ('mesh.obj', 'out.obj', '--fit', name, '--clearance', '0.1'))[:3 if name == 'bad.obj' else 1]:
            refused(place, name, content, message, *arguments)


@attack_each({
    'fewer vertices': OBJ.replace('v 0 0 1\n', '').replace('4', '1'),
    'more vertices': 'v 9 9 9\n' + OBJ,
    'fewer faces': OBJ[:OBJ.rindex('f')],
    'another face': OBJ.replace('f 1 3 2', 'f 1 2 3'),
})
def another_mesh_to_check(place, content):
    place.file('mesh.obj', OBJ)
    refused(place, 'other.obj', content, 'expected', 'check', 'mesh.obj', 'other.obj')
