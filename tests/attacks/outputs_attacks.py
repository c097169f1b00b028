# SPDX-License-Identifier: Apache-2.0
"""Outputs that would take the place of each other, or of what is read."""
import base64
import json
import os

from attack import BOX, attack, attack_each

HEIGHTS = '0.01\n0.02\n'


def set_up(place):
    """A mesh, an obstacle far away, lists, and a folder that another name leads into."""
    place.box()
    place.file('wall.obj', BOX.replace('v 0', 'v 9').replace('v 1', 'v 11'))
    place.file('wall_002.obj', BOX.replace('v 0', 'v 9').replace('v 1', 'v 11'))
    place.file('heights.txt', HEIGHTS)
    place.file('upper.txt', '0.02 ' * 8)
    place.file('more.txt', '0.01\n@upper.txt\n')
    place.file('numbers.txt', '0.1 ' * 8)
    place.file('faces.txt', '0 1')
    place.file('socket.obj', BOX)
    place.file('scene.json', '{"file": "box.obj", "offset": {"distance": 0.1}}')
    place.file('house.toml', 'distance = 0.1\n')
    os.symlink('house.toml', place.folder / 'options.csv')
    place.file('named.obj', 'mtllib named.mtl more.mtl\nmtllib two words.mtl\n' + BOX)
    for name in ('named.mtl', 'more.mtl', 'two words.mtl', 'wall.mtl'):
        place.file(name, 'newmtl a\n')
    os.symlink('two words.mtl', place.folder / 'two.csv')
    place.file('named_wall.obj', 'mtllib wall.mtl\n' + BOX.replace('v 0', 'v 9').replace('v 1', 'v 11'))
    place.run('box.obj', 'box.gltf', '-d', '0', '-q')
    text = json.loads((place.folder / 'box.gltf').read_text())
    place.file('box.bin', base64.b64decode(text['buffers'][0]['uri'].partition('base64,')[2]))
    text['buffers'][0]['uri'] = 'box.bin'
    text['images'] = [{'uri': 'red.png'}]
    place.file('box.gltf', json.dumps(text))
    place.file('red.png', 'an image')
    place.file('sub/old.json', 'old')
    os.symlink('sub', place.folder / 'link')
    os.symlink('sub/new.json', place.folder / 'dangling.json')
    os.link(place.folder / 'box.obj', place.folder / 'hard.obj')
    os.symlink('wall.obj', place.folder / 'soft.obj')


def contents(place):
    return {name: (place.folder / name).read_bytes() for name in place.names() if (place.folder / name).is_file()}


# Command lines, and the two options that must be named.
CLASHES = {
    'two by distance': ('box.obj o_{d}.obj -d 0.1 -d 0.1', 'OUTPUT: .*differ.* o_0.1.obj twice'),
    'two reports by distance': ('box.obj o.obj -d 0.1 -d 0.1 --report r_{d}.json', '--report: .*differ.* r_0.1.json twice'),
    'two states by distance': ('box.obj o.obj -d 0.1 -d 0.1 --states r_{d}.csv', '--states: .*differ'),
    'two paths by distance': ('box.obj o.obj -d 0.1 -d 0.1 --paths r_{d}.obj', '--paths: .*differ'),
    'reports on one stream': ('box.obj o.obj -d 0.1 -d 0.2 --report -', '--report: .*differ'),
    'a mesh and a report on one stream': ('box.obj - --format obj -d 0.1 --report -', '--report: .*OUTPUT'),
    'a report and the stream by another name': ('box.obj - --format obj -d 0.1 --report /dev/stdout', '--report: .*OUTPUT'),
    'a report on the mesh': ('box.obj o.obj -d 0.1 --report o.obj', '--report: .*o.obj.*OUTPUT'),
    'a report on the second mesh': ('box.obj o.obj -d 0.1 -d 0.2 --report o_{i}.obj', '--report: .*OUTPUT'),
    'a report through a link': ('box.obj sub/o.obj -d 0.1 --report link/o.obj', '--report: .*link/o.obj.*OUTPUT.*sub/o.obj'),
    'a report through a dangling link': ('box.obj o.obj -d 0.1 --format obj --report dangling.json --save-vdb sub/new.json',
                                         '--save-vdb.*--report|--report.*--save-vdb'),
    'states on the mesh': ('box.obj o.ply -d 0.1 --states ./o.ply', '--states: .*OUTPUT'),
    'paths on the mesh': ('box.obj o.obj -d 0.1 --paths sub/../o.obj', '--paths: .*OUTPUT'),
    'a refined source on the mesh': ('box.obj o.obj -d 0.1 --tolerance 9% --refined-source ./o.obj', '--refined-source: .*OUTPUT'),
    'a refined source on the input': ('box.obj o.obj -d 0.1 --tolerance 9% --refined-source hard.obj', '--refined-source: .*INPUT'),
    'a map on the refined source': ('box.obj o.obj -d 0.1 --tolerance 9% --refined-source r.obj --map r.obj',
                                    '--map: .*--refined-source'),
    'a map and a mesh on one stream': ('box.obj - --format obj -d 0.1 --tolerance 9% --map -', '--map: .*OUTPUT'),
    'paths on an obstacle': ('box.obj o.obj -d 0.1 --obstacle wall.obj --paths wall.obj', '--paths: .*--obstacle'),
    'a grid on the report': ('box.obj o.obj -d 0.1 --save-vdb r --report r', '--save-vdb: .*--report'),
    'a report on the input': ('box.obj o.obj -d 0.1 --report box.obj', '--report: .*INPUT'),
    'a report on a hard link of the input': ('box.obj o.obj -d 0.1 --report hard.obj', '--report: .*hard.obj.*INPUT.*box.obj'),
    'the mesh on an obstacle': ('box.obj wall.obj -d 0.1 --obstacle wall.obj', 'OUTPUT: .*--obstacle'),
    'the mesh on a linked obstacle': ('box.obj soft.obj -d 0.1 --obstacle wall.obj', 'OUTPUT: .*soft.obj.*--obstacle'),
    'the second mesh on an obstacle': ('box.obj wall.obj -d 0.1 -d 0.2 --obstacle wall_002.obj', 'OUTPUT: .*--obstacle'),
    'the first mesh on the input': ('wall_002.obj wall_{d}.obj -d 2 -d 002', 'OUTPUT: .*INPUT'),
    'the mesh on what it is to fit': ('box.obj socket.obj --fit socket.obj --clearance 0.1', 'OUTPUT: .*--fit'),
    'states on the numbers': ('box.obj o.obj --distance-from numbers.txt --report numbers.txt', '--report: .*--distance-from'),
    'a report on numbers by @': ('box.obj o.obj -d @numbers.txt --report numbers.txt', '--report: .*--distance'),
    'a report on the faces': ('box.obj o.obj -d 0.1 --only faces=faces.txt --report faces.txt', '--report: .*--only'),
    'a report on the heights': ('box.obj o.vtu --heights heights.txt --report heights.txt', '--report: .*--heights'),
    'a report on what heights name': ('box.obj o.vtu --heights more.txt --report upper.txt', '--report: .*--heights.*upper.txt'),
    'a report on a first height': ('box.obj o.vtu --layers 2 --first-height @numbers.txt --report numbers.txt',
                                   '--report: .*--first-height'),
    'a report on a thickness': ('box.obj o.vtu --layers 2 --total-thickness @numbers.txt --report numbers.txt',
                                '--report: .*--total-thickness'),
    'a report on an inner distance': ('box.obj o.obj -d 0.1 --shell --inner @numbers.txt --report numbers.txt',
                                      '--report: .*--inner'),
    'a report on a layer': ('box.obj o.obj --layers 2 --first-height 0.1 --report o_002.obj', '--report: .*OUTPUT'),
    'a layer on an obstacle': ('box.obj wall.obj --layers 2 --first-height 0.1 --obstacle wall_002.obj', 'OUTPUT: .*--obstacle'),
    'a layer on the input': ('wall_002.obj wall.obj --heights heights.txt', 'OUTPUT: .*INPUT'),
    'a report on the cells': ('box.obj o.vtu --layers 2 --first-height 0.1 --report o.vtu', '--report: .*OUTPUT'),
    'a report in a case': ('box.obj c/polyMesh --layers 2 --first-height 0.1 --report c/polyMesh/owner', '--report: .*OUTPUT'),
    'a report in the place of a case': ('box.obj polyMesh --layers 2 --first-height 0.1 --report polyMesh', '--report: .*OUTPUT'),
    'a report in the place of a case with a slash': ('box.obj c/polyMesh/ --layers 2 --first-height 0.1 --report c/polyMesh',
                                                     '--report: .*OUTPUT'),
    'a report on points': ('box.obj polyMesh --layers 2 --first-height 0.1 --report polyMesh/points', '--report: .*OUTPUT'),
    'a report on a surface': ('box.obj o.obj -d 0.1 --mode iso --report o.obj', '--report: .*OUTPUT'),
    'a report on the options': ('box.obj o.obj --config house.toml --report house.toml', '--report: .*house.toml.*--config'),
    'a mesh on the options': ('box.obj house.toml --format obj --config house.toml', 'OUTPUT: .*--config'),
    'states on linked options': ('box.obj o.obj --config house.toml --states options.csv', '--states: .*--config'),
    'a report on materials': ('named.obj o.obj -d 0.1 --report named.mtl', "--report: .*named.mtl.*the input's own files"),
    'a report on the second materials': ('named.obj o.obj -d 0.1 --report more.mtl', "--report: .*more.mtl.*the input's own"),
    'states on materials with blanks': ('named.obj o.obj -d 0.1 --states two.csv', "--states: .*the input's own files"),
    'a report on materials of an obstacle': ('box.obj o.obj -d 0.1 --obstacle named_wall.obj --report wall.mtl', "the input's own files"),
    'a report on materials of what it is to fit': ('box.obj o.obj --fit named_wall.obj --clearance 0.1 --report wall.mtl',
                                                 "the input's own files"),
    'a report on materials, with layers': ('named.obj o.vtu --heights heights.txt --report named.mtl', "the input's own files"),
    'a report on an image': ('box.gltf o.obj -d 0.1 --report red.png', "--report: .*red.png.*the input's own files"),
    'a report on numbers beside': ('box.gltf o.obj -d 0.1 --report box.bin', "the input's own files"),
    'two surfaces': ('box.obj o_{d}.obj -d 0.1 -d 0.1 --mode iso', 'OUTPUT: .*differ'),
    'the mesh of a scene': ('scene.json box.obj', "OUTPUT: .*the input's own files"),
    'a report on the mesh of a scene': ('scene.json o.obj --report box.obj', "--report: .*the input's own files"),
    'a scene': ('scene.json scene.json --format obj', 'OUTPUT: .*INPUT'),
    'a plan that never would be': ('box.obj o.obj -d 0.1 --report box.obj --dry-run', '--report: .*INPUT'),
    'fit to itself': ('box.obj o.obj --fit hard.obj --clearance 0.1', '--fit: .*input'),
    'a grid on a stream': ('box.obj o.obj -d 0.1 --save-vdb -', "--save-vdb: .*'-'"),
    'check: source': ('check box.obj wall.obj --report box.obj', '--report: .*SOURCE'),
    'check: offset': ('check box.obj wall.obj --report soft.obj', '--report: .*OFFSET'),
    'check: obstacle': ('check box.obj box.obj --obstacle wall.obj --report wall.obj', '--report: .*--obstacle'),
    'check: faces': ('check box.obj box.obj --only faces=faces.txt --report faces.txt', '--report: .*--only'),
    'check: numbers': ('check box.obj box.obj --distance-from numbers.txt --report numbers.txt', '--report: .*--distance-from'),
    'check: materials': ('check named.obj named.obj --report named.mtl', "--report: .*the input's own files"),
    'check: stream by another name': ('check box.obj box.obj --json --report /dev/stdout', '--report: .*--json'),
    'check: stream': ('check box.obj box.obj --json --report -', '--report: .*--json'),
}


@attack_each(CLASHES)
def clash(place, case):
    line, says = case
    set_up(place)
    before = contents(place)
    place.refused(place.run(*line.split()), 1, says)
    place.check(contents(place) == before, 'expected every file as it was')


@attack
def clash_with_redirected_output(place):
    set_up(place)
    with open(place.folder / 'r.json', 'wb') as out:
        run = place.run('box.obj', '-', '--format', 'obj', '-d', '0.1', '--report', 'r.json', stdout=out)
    place.refused(run, 1, '--report: .*r.json.*OUTPUT')


# What may be one file.
FINE = {
    'in place': 'box.obj box.obj -d 0.1 --report r.json',
    'in place through a hard link': 'box.obj hard.obj -d 0.1',
    'in place by a list': 'box.obj o.obj -d @numbers.txt --only faces=faces.txt',
    'an obstacle twice': 'box.obj o.obj -d 0.1 --obstacle wall.obj --obstacle soft.obj',
    'into nothing': 'box.obj /dev/null --format obj -d 0.1 --report /dev/null --save-vdb /dev/null',
    'one scene, two distances': 'scene.json o_{d}.obj -d 0.1 -d 0.2 --report r_{i}.json',
}


@attack_each(FINE)
def no_clash(place, line):
    set_up(place)
    place.ended_well(place.run(*line.split()), 0)


# What cannot be written beside states of a check, which then stay as they were.
@attack_each({name: name for name in ('/dev/full', 'nowhere/r.json', 'sub', 'locked/r.json')})
def check_writes_all_or_nothing(place, report):
    set_up(place)
    place.file('s.csv', 'as before')
    place.file('locked/x', '')
    os.chmod(place.folder / 'locked', 0o500)
    run = place.run('check', 'box.obj', 'box.obj', '--states', 's.csv', '--html', 'new.html', '--report', report)
    os.chmod(place.folder / 'locked', 0o700)
    if report == 'locked/r.json' and os.geteuid() == 0:
        return  # who may write everywhere
    place.refused(run, 4)
    place.check((place.folder / 's.csv').read_bytes() == b'as before', 'expected the states as they were')
    place.check('new.html' not in place.names(), 'expected no page')


@attack
def report_and_summary_are_not_mixed(place):
    place.box()
    for name in ('-', '/dev/stdout'):
        for line in (['box.obj', 'o.obj', '-d', '0.1'], ['check', 'box.obj', 'o.obj']):
            run = place.run(*line, '--report', name)
            place.ended_well(run, 0)
            place.check(run.out.startswith(b'{') and run.out.endswith(b'}\n'), 'expected nothing but a report', run)
        run = place.run('box.obj', name, '--format', 'obj', '-d', '0.1')
        place.ended_well(run, 0)
        place.check(b'reached' not in run.out and b'reached' in run.err, 'expected nothing but a mesh', run)


# A report in the place of what is written beside a .gltf.
@attack_each({'numbers of a layer': 'box.gltf sub/o.gltf --layers 2 --first-height 0.1 --report sub/o_001.bin',
              'a copied image': 'box.gltf sub/o.gltf -d 0.1 --report sub/red.png',
              'numbers beside a packed one': 'box.gltf sub/o.gltf.gz -d 0.1 --report sub/o.gltf.gz_1.bin'})
def nothing_is_written_twice(place, line):
    set_up(place)
    before = contents(place)
    place.refused(place.run(*line.split()), 4, 'expected a file of its own')
    place.check(contents(place) == before, 'expected nothing written')


@attack
def an_image_of_several_outputs_is_copied_once(place):
    set_up(place)
    place.ended_well(place.run('box.gltf', 'sub/o{i}.gltf', '-d', '0.1', '-d', '0.2'), 0)
    place.check((place.folder / 'sub/red.png').read_bytes() == b'an image', 'expected a copy')
