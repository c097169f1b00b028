# SPDX-License-Identifier: Apache-2.0
"""Scenes that are cut, have keys of other kinds, or ask for what cannot be."""
import json

from attack import attack_each
from hostile import HUGE, OBJ, refused

SHAPE, OFFSET = '"shape": {"type": "cube", "side": 1, "divisions": 2}', '"offset": {"distance": 0.1}'
SCENE = f'{{{SHAPE}, {OFFSET}}}'
assert json.loads(SCENE)


def shape(**keys):
    return json.dumps({'shape': keys, 'offset': {'distance': 0.1}})


def cube(side='1', divisions='2', more=''):
    return f'{{"shape": {{"type": "cube", "side": {side}, "divisions": {divisions}{more}}}, {OFFSET}}}'


def offset(text):
    return f'{{{SHAPE}, "offset": {text}}}'


def with_key(text):
    return f'{SCENE[:-1]}, {text}}}'


JSON = 'expected JSON'
# What each message says behind the name of the file.
SCENES = {
    'empty': ('', JSON),
    'null': ('null', "expected an object at ''"),
    'nothing in it': ('{}', "expected an object at 'shape'"),
    'cut in a number': (SCENE[:-3], JSON),
    'cut before its end': (SCENE[:-1], JSON),
    'words behind': (SCENE + ' {', JSON),
    'a comment': ('// scene\n' + SCENE, JSON),
    'UTF-16': (SCENE.encode('utf-16'), JSON),
    'bytes that are no text': (SCENE.replace('cube', '\xff').encode('latin-1'), JSON),
    'a text without an end': ('"' + 'x' * (1 << 20), JSON),
    'lists in lists': ('[' * 100000, JSON),
    'lists in lists, closed': ('[' * 100000 + ']' * 100000, "expected an object at ''"),
    'objects in objects': ('{"shape":' * 100000 + '1' + '}' * 100000,
                           'expected a text at|expected an object at|expected no key'),
    'a number beyond all': (cube(side='1e999'), JSON),
    'a key twice': (SCENE[:-1] + f', {OFFSET}}}', "expected the key 'offset' once"),
    'a key twice, deeper': (cube(more=', "side": 2'), "expected the key 'shape.side' once|expected the key 'side' once"),
    'an unknown key': (with_key('"more": 1'), "expected no key 'more'"),
    'a key of 1 MiB': (with_key(f'"{"x" * (1 << 20)}": 1'), 'expected no key'),
    'a key of two lines': (with_key('"a\\nb": 1'), 'expected no key'),
    'an unknown key of the shape': (cube(more=', "radius": 1'), "expected no key 'shape.radius'"),
    'no type': (shape(side=1), "expected a text at 'shape.type'"),
    'an unknown type': (shape(type='dodecahedron'), "a type among .*cube.*, not 'dodecahedron'"),
    'a type of 1 MiB': (shape(type='x' * (1 << 20)), 'a type among'),
    'a side that is a text': (cube(side='"1"'), "expected a number at 'shape.side'"),
    **{f'divisions {n}': (cube(divisions=n), "expected a whole number .*at 'shape.divisions'")
       for n in ('2.5', '-1', HUGE['2^31'], HUGE['2^63'], HUGE['2^64'])},
    'no side at all': (cube(side='0'), 'expected'),
    'no offset': (f'{{{SHAPE}}}', "expected an object at 'offset'"),
    'a distance that is a list': (offset('{"distance": [1]}'), "expected a number at 'offset.distance'"),
    'a distance that is no number': (offset('{"distance": "x+"}'), 'distance'),
    'a box of two numbers': (offset('{"distance": 0.1, "only": {"lower": [0, 0], "upper": [1, 1, 1]}}'),
                             "three numbers at 'offset.only.lower'"),
    'a fit and a distance': (offset('{"fit": {}, "distance": 1}'), "'fit' without 'distance'"),
    'a file that is none': (f'{{"file": "nothing.obj", {OFFSET}}}', 'nothing.obj: cannot be opened'),
    'a file that is itself': (f'{{"file": "hostile.json", {OFFSET}}}', 'expected a name that ends in'),
    'an expectation of another kind': (with_key('"expect": []'), "expected an object at 'expect'"),
}


@attack_each(SCENES)
def scene(place, case):
    """The distance is that of the scene."""
    refused(place, 'hostile.json', *case, 'hostile.json', 'out.obj')
