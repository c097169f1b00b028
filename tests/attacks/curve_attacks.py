# SPDX-License-Identifier: Apache-2.0
"""Files of plane curves that are cut, lie, or are something else."""
from hostile import HUGE, attack_files, gzipped

END = 'the end of the (file|line)'
SQUARE = '0 0\n1 0\n1 1\n0 1\n0 0\n'

TEXT = {
    'as it is': (SQUARE, 5),
    'empty': ('', 'byte 0', 'curves', 'an empty file'),
    'only a title': ('NACA 0012\n', r'line \d', "at least one line 'x y'", END),
    'two titles': ('NACA 0012\nof old\n' + SQUARE, 'line 2', 'a coordinate', "'of'"),
    'points alone': ('0 0\n\n1 0\n\n0 1\n', None, r'expected a curve of 2 points or more, got single points alone \(3\)'),
    'a line of three': (SQUARE + '1 2 3\n', 'line 6', '2 coordinates, as in the lines before', "'3'"),
    **{f'coordinate {x}': (f'0 0\n1 {x}\n', 'line 2', 'a coordinate', '') for x in ('nan', '1e999', '1\0')},
    'counts of more than there are': ('RAE\n100. 100.\n\n' + SQUARE, 5),
    'a mark of byte order': (b'\xef\xbb\xbf' + SQUARE.encode(), 5),
    'lines that end in CR': (SQUARE.replace('\n', '\r'), 5),
    'UTF-16': (SQUARE.encode('utf-16'), r'line \d', 'a coordinate|at least one line', ''),
    'a title of 1 MiB': ('x' * (1 << 20) + '\n' + SQUARE, 5),
    'a word of 1 MiB': (SQUARE + 'x' * (1 << 20) + ' 1\n', 'line 6', 'a coordinate', ''),
    'so far apart that no number tells': ('-1e308 0\n1e308 1e308\n', None, 'expected'),
}

LINES = 'v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n'
OBJ = {
    'as it is': (LINES, 3),
    'a point cut': (LINES + 'v 1', 'line 5', 'a coordinate', END),
    'an element of one': (LINES + 'l 1\n', 'line 5', 'at least 2 points', ''),
    **{f'index {x}': (LINES + f'l 1 {x}\n', 'line 5', 'a vertex index', '')
       for x in ('0', '4', '-4', '4294967296')},
    'coordinate nan': ('v nan 0 0\n' + LINES, 'line 1', 'a coordinate', 'nan'),
    'a point of one place': (LINES + 'l 1 1\n', 3),
}


def svg(inside, root='svg xmlns="http://www.w3.org/2000/svg"'):
    return f'<{root}>{inside}</{root.split()[0]}>\n'


def path(d, more=''):
    return svg(f'<path d="{d}"{more}/>')


def uses(depth, each, inside='<path d="M0 0L1 1"/>'):
    """Groups, each of which shows the one before several times."""
    groups = ''.join(f'<g id="g{k + 1}">' + f'<use href="#g{k}"/>' * each + '</g>' for k in range(depth))
    return f'<defs><g id="g0">{inside}</g>{groups}</defs><use href="#g{depth}"/>'


def nested(depth):
    return svg('<g>' * depth + '<path d="M0 0L1 0"/>' + '</g>' * depth)


WHERE = 'line 1'
SVG = {
    'as it is': (path('M0 0 L1 0 L1 1 Z'), 3),
    'empty': ('', 'byte 0', 'curves', 'an empty file'),
    'cut in a tag': (path('M0 0L1 0')[:60], WHERE, 'XML', ''),
    'nothing drawn': (svg(''), r'line \d', 'a path or another shape', 'none'),
    'a point alone': (path('M0 0'), None, 'expected'),
    **{f'path {d}': (path(d), WHERE, '', '') for d in (
        'L1 0', 'M', 'M0 0L1', 'M0 0C1 1 2 2 3', 'M0 0B1 1', 'M0 0A1 1 0 2 0 1 1', 'M0 0A1 1 0 1', 'M0 0Q1e308 0 1e999 0', 'M1e308 0q1e308 0 1e308 1', 'M0 0L1e999 0', 'M1e308 0l1e308 0', 'M0 0L--1 0', 'M0 0Z1 1')},
    'points of an odd number': (svg('<polygon points="0 0 1 0 1"/>'), WHERE, 'a number for y', 'its end'),
    **{f'transform {t}': (path('M0 0L1 0', f' transform="{t}"'), WHERE, '', '') for t in (
        'scale(0)', 'scale(1', 'matrix(1 2 3)', 'scale(1e200)scale(1e200)')},
    'a circle': (svg('<circle r="1"/>'), 420),
    'an arc that is hardly one': (path('M0 0A1e300 1e-300 1e300 1 1 1 0'), WHERE, 'coordinates that are numbers', 'larger ones'),
    'curves to the ends of all numbers': (path('M0 0C1e308 0 0 1e308 1 1'), None, 'expected'),
    'a circle larger than any number': (svg('<circle r="1e308" cx="1e308"/>'), WHERE, 'coordinates that are numbers', 'larger ones'),
    'a length in percent': (svg('<circle r="50%"/>'), WHERE, 'a number, alone or with px, mm', "'50%'"),
    'a radius below 0': (svg('<circle r="-1"/>'), WHERE, "'r' of 0 or more", "'-1'"),
    'a use of itself': (svg('<use id="a" href="#a"/>'), WHERE, 'something else than what it is part of', 'a circle'),
    'a use of nothing': (svg('<use href="#a"/>'), WHERE, "an element with the id 'a'", 'none'),
    'a use of a file': (svg('<use href="/etc/passwd#a"/>'), WHERE, 'a reference to an element of this file', 'passwd'),
    'uses of uses of uses': (svg(uses(12, 10)), WHERE, "'use' of 1000000 elements at most", 'more'),
    'uses of nothing in uses': (svg(uses(12, 10, '')), WHERE, "'use' of 1000000 elements at most", 'more'),
    'a chain of 100,000 uses': (svg(uses(100000, 1)), WHERE, '100 deep', 'more'),
    'a drawing in it': (svg(svg('')), WHERE, "one element 'svg'", 'another one'),
    'entities of entities': ('<!DOCTYPE svg [<!ENTITY a "' + 'x' * 1000 + '">' + ''.join(
        f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip('abcdefgh', 'bcdefghi')) + ']>' + svg('&i;<path d="M0 0L1 0"/>'),
        WHERE, 'XML', ''),
    'an entity of a file': ('<!DOCTYPE svg [<!ENTITY a SYSTEM "/etc/passwd">]>' + svg('&a;<path d="M0 0 L1 0"/>'), 2),
    '100,000 groups in each other': (nested(100000), 2),
    'UTF-16': (path('M0 0L1 0').encode('utf-16'), WHERE, 'a drawing in UTF-8', 'UTF-16'),
    'zeros': (bytes(1000), WHERE, 'XML', ''),
    'bytes that are no text': (svg('<g id="\xff"/>').encode('latin-1'), WHERE, 'XML', 'invalid token'),
}
attack_files(__name__, 'text', 'txt', TEXT)
attack_files(__name__, 'elements', 'obj', OBJ)
attack_files(__name__, 'drawing', 'svg', SVG)
