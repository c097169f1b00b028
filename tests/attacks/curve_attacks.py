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


def dxf(entities, blocks='', header=''):
    """A DXF file of words: a code and a value by turns."""
    def section(name, inside):
        return f'0 SECTION 2 {name} {inside} 0 ENDSEC ' if inside else ''
    words = section('HEADER', header) + section('BLOCKS', blocks) + f'0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF'
    return '\n'.join(words.split()) + '\n'


def inserts(depth, each, inside='0 LINE 11 1'):
    """Blocks, each of which shows the one before several times."""
    return f'0 BLOCK 2 b0 {inside} 0 ENDBLK ' + ''.join(
        f'0 BLOCK 2 b{k + 1} ' + f'0 INSERT 2 b{k} ' * each + '0 ENDBLK ' for k in range(depth))


LINE = '0 LINE 8 a 10 0 20 0 11 1 21 1 '
SPLINE = '0 SPLINE 71 1 40 0 40 0 40 1 40 1 10 0 20 0 10 1 20 1'
BLOCK = '0 BLOCK 2 b 0 ENDBLK'
DXF = {
    'as it is': (dxf(LINE), 2),
    'empty': ('', 'byte 0', 'curves', 'an empty file'),
    'cut in a section': (dxf(LINE)[:30], r'line \d+', "'ENDSEC'", 'the end of the file'),
    'cut before the last section ends': (dxf(LINE)[:-15], r'line \d+', "'ENDSEC'", 'the end of the file'),
    'a code alone': (dxf(LINE)[:-14], r'line \d+', 'a value behind a group code', 'the end of the file'),
    'no entities': (dxf('0 TEXT 1 a'), r'line \d+', 'a curve', 'none in the drawing'),
    'zeros': (bytes(1000), 'line 1', 'a group code', ''),
    'binary': ('AutoCAD Binary DXF\r\n\x1a\0' + '\0' * 100, 'line 1', 'a DXF file in ASCII', 'a binary one'),
    'UTF-16': (dxf(LINE).encode('utf-16'), 'line 1', 'a group code', ''),
    'a code of 1 MiB': ('0' * (1 << 20) + '\nSECTION\n', 'line 3', 'the name of a section', 'the end of the file'),
    **{f'coordinate {x}': (dxf(f'0 LINE 10 {x}'), 'line 8', 'a number behind the group code 10', '')
       for x in ('nan', 'inf', '1e999', '1\0', '0x10')},
    **{f'flags {x}': (dxf(f'0 POLYLINE 70 {x}'), 'line 8', 'a (whole )?number', '') for x in ('nan', '1.5', '1e300')},
    'coordinates to the ends of all numbers': (dxf('0 LINE 10 -1e308 20 0 11 1e308 21 1e308'), None, 'expected'),
    'a circle larger than any number': (dxf('0 CIRCLE 10 1e308 20 0 40 1e308'), 'line 5', 'coordinates that are numbers', 'larger'),
    'numbers of 1e300': (dxf(SPLINE.replace('40 1', '40 1e300').replace('20 1', '20 1e300')), None, ''),
    'an arc of 1e300 degrees': (dxf('0 ARC 10 0 20 0 40 1 50 0 51 1e300'), 418),
    'a bulge of 1e300': (dxf('0 LWPOLYLINE 10 0 20 0 42 1e300 10 1 20 0'), None, ''),
    'a count of 2^31 vertices': (dxf('0 LWPOLYLINE 90 2147483648 10 0 20 0 10 1 20 0'), 2),
    'counts of a spline': (dxf(SPLINE.replace('71 1', '71 1 72 2147483647 73 2147483647')), 2),
    'a spline of degree 1e9': (dxf(SPLINE.replace('71 1', '71 1000000000')), 'line 5', 'a degree from 1 to 25', ''),
    'a spline of huge weights': (dxf(SPLINE + ' 41 1e-300 41 1e300'), 2),
    'an INSERT of itself': (dxf('0 INSERT 2 b', '0 BLOCK 2 b 0 INSERT 2 b 0 ENDBLK'), r'line \d+', 'something else than it is part of', 'a circle'),
    'an INSERT of nothing': (dxf('0 INSERT 2 c', BLOCK), r'line \d+', "a block 'c'", 'none'),
    'INSERT of INSERT of INSERT': (dxf('0 INSERT 2 b12', inserts(12, 10)), r'line \d+', 'INSERT of 1000000 entities at most', 'more'),
    'INSERT of nothing in INSERT': (dxf('0 INSERT 2 b12', inserts(12, 10, '')), r'line \d+', 'INSERT of 1000000 entities at most', 'more'),
    'a chain of 100,000 INSERT': (dxf('0 INSERT 2 b100000', inserts(100000, 1)), r'line \d+', '100 deep', 'more'),
    'rows and columns without end': (dxf('0 INSERT 2 b 70 1000000000 71 1000000000', BLOCK), r'line \d+', 'INSERT of 1000000 entities at most', 'more'),
    'a scale of 0': (dxf('0 INSERT 2 b 41 0', BLOCK), r'line \d+', 'scales that are not 0', '0'),
    'aside': (dxf('0 CIRCLE 40 1 210 1 220 1 230 0'), 'line 5', 'an extrusion direction', r'\(1, 1, 0\)'),
    '100,000 lines in one place': (dxf(LINE * 100000), 200000),
}
attack_files(__name__, 'text', 'txt', TEXT)
attack_files(__name__, 'elements', 'obj', OBJ)
attack_files(__name__, 'drawing', 'svg', SVG)
attack_files(__name__, 'entities of a drawing', 'dxf', DXF)
