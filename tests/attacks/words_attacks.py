# SPDX-License-Identifier: Apache-2.0
"""Messages that are too long to read or not text, numbers that are none, and names that look like options."""
import os
import resource

from attack import BOX, attack, attack_each

LONG = 'a' * 3000
DISTANCE = ('-d', '0.1')


def many_groups(place):
    place.file('groups.obj', BOX + ''.join(f'g group_number_{i}\nf 1 2 3\n' for i in range(20000)))
    return ['groups.obj', 'o.obj', *DISTANCE, '--only', 'group=none']


def many_properties(place):
    head = ''.join(f'property float property_number_{i}\n' for i in range(3000))
    vertex = ' '.join(['0'] * 3000)
    place.file('p.ply', 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n' +
               head + 'element face 1\nproperty list uchar int vertex_indices\nend_header\n' +
               f'0 0 0 {vertex}\n1 0 0 {vertex}\n0 1 0 {vertex}\n3 0 1 2\n')
    return ['p.ply', 'o.ply', '--distance-from', 'ply:none']


# What is said, and the code.
LONG_LINES = {
    'group': (1, many_groups, "got 'none'"), 'property': (2, many_properties, 'none'),
    'input': (2, [LONG + '.obj', 'o.obj', *DISTANCE], 'aaa.*\\.obj: cannot'),
    'input of many folders': (2, [(LONG[:200] + '/') * 15 + 'a.obj', 'o.obj', *DISTANCE], 'cannot'),
    'output': (4, ['box.obj', LONG + '.obj', *DISTANCE], 'aaa.*\\.obj: cannot'),
    'report': (4, ['box.obj', 'o.obj', *DISTANCE, '--report', LONG], 'cannot'),
    'grid': (4, ['box.obj', 'o.obj', *DISTANCE, '--save-vdb', LONG + '.vdb'], 'cannot'),
    'states': (1, ['box.obj', 'o.obj', *DISTANCE, '--states', LONG], 'aaa: expected a file of states'),
    'paths': (1, ['box.obj', 'o.obj', *DISTANCE, '--paths', LONG], 'expected a file of paths'),
    'heights': (2, ['box.obj', 'o.vtu', '--heights', LONG], 'cannot'),
    'refined source': (4, ['box.obj', 'o.obj', *DISTANCE, '--tolerance', '9%', '--refined-source', LONG + '.obj'], 'cannot'),
    'map': (4, ['box.obj', 'o.obj', *DISTANCE, '--tolerance', '9%', '--map', LONG], 'cannot'),
    'tolerance': (1, ['box.obj', 'o.obj', *DISTANCE, '--tolerance', LONG], "--tolerance: expected .*, got 'aaa"),
    'obstacle': (2, ['box.obj', 'o.obj', *DISTANCE, '--obstacle', LONG + '.obj'], 'cannot'),
    'name': (1, [LONG, 'o.obj', *DISTANCE], 'aaa: expected an input that ends in'),
    'word': (1, ['box.obj', 'o.obj', *DISTANCE, '--solver', LONG], "--solver: expected 'closest' or 'eikonal', got 'aaa"),
    'words': (1, ['box.obj', 'o.obj', *DISTANCE, '--mode', 'a b ' * 3000], '--mode: expected'),
    'number': (1, ['box.obj', 'o.obj', *DISTANCE, '--threads', '1' * 3000], '--threads: expected 0 to 4096'),
    'distance': (1, ['box.obj', 'o.obj', '-d', LONG], '--distance: '),
    'distance by axis': (1, ['box.obj', 'o.obj', '--distance-xy', LONG, '--distance-z', '1'], '--distance-xy: '),
    'part': (1, ['box.obj', 'o.obj', *DISTANCE, '--only', LONG], "--only: expected 'group=NAME'"),
    'part that is not there': (1, ['box.obj', 'o.obj', *DISTANCE, '--only', 'group=' + LONG], 'has no groups'),
    'plane': (1, ['box.obj', 'o.obj', *DISTANCE, '--symmetry', LONG], '--symmetry: expected'),
    'list': (1, ['box.obj', 'o.obj', *DISTANCE, '--mode', 'iso', '--transport', LONG], '--transport: expected'),
    'option': (1, ['box.obj', 'o.obj', *DISTANCE, '--' + LONG], 'unknown option --aaa'),
    'arguments': (1, ['box.obj', 'o.obj', *DISTANCE, *['a'] * 5000], 'not expected'),
    'option with lines': (1, ['box.obj', 'o.obj', *DISTANCE, '--a\nb\n'], 'unknown option --a.x0ab'),
    'name with lines': (2, ['a\n' * 200 + '.obj', 'o.obj', *DISTANCE], 'cannot'),
    'not text': (2, [b'\xff' * 250 + b'.obj', 'o.obj', *DISTANCE], r'\\xff.*cannot'),
    'clash': (1, ['box.obj', 'sub/../' * 300 + 'o.obj', *DISTANCE, '--report', './' * 900 + 'o.obj'], '--report: .*OUTPUT'),
    'check': (2, ['check', LONG + '.obj', 'box.obj'], 'cannot'),
    'check offset': (2, ['check', 'box.obj', LONG + '.obj'], 'cannot|ends in'),
    'check option': (1, ['check', 'box.obj', 'box.obj', '--' + LONG], 'unknown option --aaa'),
    'view': (2, ['view', LONG + '.obj', '--no-open', '--html', 'p.html'], 'cannot'),
    'view page': (1, ['view', 'box.obj', '--no-open', '--html', LONG], 'expected a page'),
    'scene': (2, ['scene.json', 'o.obj'], 'scene.json'),
    'check of a shape': (2, ['check', 'shape.json', 'box.obj'], "shape.json: expected a mesh.* got a scene's shape"),
}


@attack_each(LONG_LINES)
def long_line(place, case):
    code, arguments, says = case
    place.box()
    (place.folder / 'sub').mkdir()
    place.file('scene.json', '{"shape": {"type": "' + LONG + '"}, "offset": {"distance": 0.1}}')
    place.file('shape.json', '{"shape": {"type": "icosphere", "radius": 1, "subdivisions": 1}, "offset": {"distance": 0.1}}')
    arguments = arguments(place) if callable(arguments) else [a if isinstance(a, bytes) else a.encode() for a in arguments]
    place.refused(place.run(*map(os.fsdecode, arguments)), code, says)


@attack
def grid_under_a_limit(place):
    """It was written, cut short, and read again to find out: names of a length that is rubbish."""
    place.box()
    for most in (0, 100, 1000, 3000, 10000, 30000):
        run = place.run('box.obj', 'o.obj', *DISTANCE, '--save-vdb', 'v.vdb', limits=[(resource.RLIMIT_FSIZE, most)])
        place.refused(run, 4, '^vdb_offset: v.vdb: cannot be written: File too large$')
        place.check(place.names() == ['box.obj'], 'expected no file', run)


@attack
def names_that_are_not_text(place):
    place.file(os.fsdecode(b'b\xff.obj'), BOX)
    place.file('g.obj', b'g \xff\xfe\nusemtl \xff\n' + BOX.encode())
    odd = os.fsdecode(b'o\xff')
    for line in ([os.fsdecode(b'b\xff.obj'), odd + '.obj', *DISTANCE, '--save-vdb', odd + '.vdb', '--states', odd + '.csv'],
                 [os.fsdecode(b'b\xff.obj'), odd + '.vtu', '--layers', '2', '--first-height', '0.1'],
                 ['check', os.fsdecode(b'b\xff.obj'), odd + '.obj'],
                 [os.fsdecode(b'b\xff.obj'), odd + '.ply', *DISTANCE, '--mode', 'iso', '--voxel-size', '0.3'],
                 ['g.obj', 'o.obj', *DISTANCE, '--only', os.fsdecode(b'group=\xff\xfe')],
                 ['g.obj', odd + '.msh', '--layers', '2', '--first-height', '0.1']):
        place.ended_well(place.run(*line, '--report', odd + '.json'), 0)
        report = (place.folder / (odd + '.json')).read_bytes()
        place.check(report.startswith(b'{') and report.endswith(b'}\n'), 'expected a whole report')
        report.decode()
    run = place.run('check', os.fsdecode(b'b\xff.obj'), odd + '.obj', '--json')
    place.ended_well(run, 0)
    run.out.decode()


# Options that take a number, and what stands around them.
NUMBERS = {'--voxel-size': (), '--voxels-per-distance': (), '--threads': (), '--precision': (), '--weld': (),
           '--max-memory': (), '--tolerance': (), '--max-faces': ('--tolerance', '1%'), '--adaptivity': ('--mode', 'iso'), '--clearance': ('--obstacle', 'wall.obj'),
           '--flatten': (),
           '--symmetry': ()}
# No numbers: hexadecimal, octal as C has it, out of range, two signs, blanks, commas, lists.
FEW_NO_NUMBERS = ('0x10', '1e-400', '+-1')
NO_NUMBERS = (*FEW_NO_NUMBERS, '1e400', 'nan', '1,5', ' 1', '[1]', '1e', '0x1p3', 'inf', '1 ', '1f', '1_0', '0b1', '.', '١')


@attack_each({option: option for option in NUMBERS})
def no_number(place, option):
    place.box()
    place.file('wall.obj', BOX.replace('v 0', 'v 9').replace('v 1', 'v 11'))
    one_of_each_kind = option in ('--voxel-size', '--threads') and not place.sanitized
    for text in NO_NUMBERS if one_of_each_kind else FEW_NO_NUMBERS:
        value = 'x=' + text if option == '--symmetry' else text
        place.refused(place.run('box.obj', 'o.obj', *DISTANCE, *NUMBERS[option], f'{option}={value}'), 1, option)
    place.check('o.obj' not in place.names(), 'expected no file')


@attack
def no_number_for_layers(place):
    place.box()
    for text in FEW_NO_NUMBERS:
        place.refused(place.run('box.obj', 'o.vtu', f'--layers={text}', '--first-height', '0.1'), 1, '--layers|[Ll]ayers')
        place.refused(place.run('box.obj', 'o.vtu', '--layers', '2', '--first-height', '0.1', f'--growth={text}'), 1, '--growth')


@attack
def no_distance(place):
    """Blanks are fine here, as in an expression."""
    place.box()
    for text in (*FEW_NO_NUMBERS, 'nan', '1f'):
        if text != '+-1':  # of an expression, signs are operators
            place.refused(place.run('box.obj', 'o.obj', f'--distance={text}'), 1, '--distance')
        place.refused(place.run('box.obj', 'o.obj', f'--distance-xy={text}', '--distance-z=1'), 1, '--distance-xy')
    for text in ('[1]', '[0.1,0.2]', '{1}'):
        place.refused(place.run('box.obj', 'o.obj', '-d', text), 1, "--distance: distance '.*column 1")
        place.refused(place.run('check', 'box.obj', 'box.obj', '-d', text), 1, '--distance: ')


@attack
def nothing_given(place):
    """An empty variable of a script is not the same as no option."""
    place.box()
    for line, option in ((['', 'o.obj', *DISTANCE], 'INPUT'), (['box.obj', '', *DISTANCE], 'OUTPUT'),
                         (['box.obj', 'o.obj', *DISTANCE, '--report', ''], '--report'),
                         (['box.obj', 'o.obj', '-d', ''], '--distance'), (['check', 'box.obj', ''], 'OFFSET'),
                         (['box.obj', 'o.obj', *DISTANCE, '--max-memory', ''], '--max-memory'),
                         (['check', 'box.obj', 'box.obj', '-d', ''], '--distance')):
        place.refused(place.run(*line), 1, f"{option}: expected a value, got ''")
    for number in ('0', '18'):
        place.refused(place.run('box.obj', 'o.obj', *DISTANCE, '--precision', number), 1, '--precision: expected 1 to 17')


@attack
def numbers(place):
    place.box()
    for option, text in (('--threads', '010'), ('--threads', '+1'), ('--voxel-size', '+5e-1'), ('--weld', '+1e-9'),
                         ('--voxel-size', '0.500000000000000000001'), ('--max-memory', '+4G'), ('--symmetry', 'x=+1'),
                         ('--precision', '017')):
        place.ended_well(place.run('box.obj', 'o.obj', '-d', '+0.100000000000000000001', option, text), 0)
    place.refused(place.run('box.obj', 'o.obj', *DISTANCE, '--threads', '1' * 21), 1, '--threads: expected 0 to 4096')


@attack_each({'moved': (), 'captured': ('--mode', 'iso'), 'planned': ('--dry-run',)})
def voxel_too_large(place, more):
    place.box()
    for option in (('--voxel-size', '1e21'), ('--voxel-size', '8'), ('--voxels-per-distance', '1e-21'),
                   ('--voxels-per-distance', '0.001')):
        place.refused(place.run('box.obj', 'o.obj', *DISTANCE, *option, *more), 3, 'voxel size of at most 7.3')
    sizes = ('0.5',) if '--mode' in more else ('7.3', '2')  # what is thinner than a voxel may have no surface
    for size in sizes:
        place.ended_well(place.run('box.obj', 'o.obj', *DISTANCE, '--voxel-size', size, *more), 0)
    place.file('c.txt', '0 0\n1 0\n1 1\n0 1\n0 0\n')
    if '--mode' not in more:
        place.refused(place.run('c.txt', 'o.txt', *DISTANCE, '--voxel-size', '1e21', *more), 3, 'voxel size of at most')


@attack
def names_with_a_dash(place):
    for name in ('-a.obj', '--report', '--', '-d', '--help.obj', '-1.obj', '-'):
        place.file(name, BOX)
    for first, second in (('-a.obj', '-o.obj'), ('--help.obj', '--version.obj'), ('-1.obj', '-2.obj')):
        place.ended_well(place.run(*DISTANCE, '--', first, second), 0)
        place.check(second in place.names(), f'expected {second}')
        place.ended_well(place.run('check', *DISTANCE, '--', first, second), 0)
    for first in ('--report', '--', '-d'):
        place.ended_well(place.run(*DISTANCE, '--format', 'obj', '--', first, '-o.obj'), 0)
    place.ended_well(place.run(*DISTANCE, '--report=-r.json', '--', '-a.obj', '-p.obj'), 0)
    place.check({'-p.obj', '-r.json'} <= set(place.names()), 'expected -p.obj and -r.json')
