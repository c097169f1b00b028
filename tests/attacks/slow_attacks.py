# SPDX-License-Identifier: Apache-2.0
"""Files that take a time out of all proportion to their size."""
import math
import random

from attack import BOX, attack, attack_each


def part(place, size):
    """Sanitized, what takes seconds takes a minute."""
    return size // 10 if place.sanitized else size


def star(corners):
    def place_of(i):
        angle, radius = 2 * math.pi * i / corners, 1 - i % 2 / 2
        return f'v {radius * math.cos(angle):.9g} {radius * math.sin(angle):.9g} 0\n'
    return ''.join(map(place_of, range(corners))) + 'f ' + ' '.join(str(i + 1) for i in range(corners)) + '\n'


def sphere(middle):
    """24 by 48 faces, radius 1."""
    lines = [f'v {middle!r} 0 {z}\n' for z in (-1, 1)]
    for i in range(1, 24):
        for j in range(48):
            a, b = math.pi * i / 24, math.pi * j / 24
            lines.append(f'v {middle + math.sin(a) * math.cos(b)!r} {math.sin(a) * math.sin(b)!r} {-math.cos(a)!r}\n')
    for j in range(48):
        k = (j + 1) % 48
        lines.append(f'f 1 {3 + k} {3 + j}\nf 2 {3 + 22 * 48 + j} {3 + 22 * 48 + k}\n')
        for i in range(22):
            a = 3 + 48 * i
            lines.append(f'f {a + j} {a + k} {a + 48 + k} {a + 48 + j}\n')
    return ''.join(lines)


@attack_each({'topology': (), 'iso': ('--mode', 'iso')})
def polygon(place, more):
    place.file('star.obj', star(part(place, 20000 if not more else 10000)))
    place.ended_well(place.run('star.obj', 'out.obj', '-d', '1%', *more), 0)


def ring(count, z):
    return ''.join(f'v {math.cos(2 * math.pi * i / count):.9g} {math.sin(2 * math.pi * i / count):.9g} {z}\n' for i in range(count))


def around(count, hub, first, turned=False):
    """Triangles from a vertex to a ring."""
    pairs = [(first + i, first + (i + 1) % count) for i in range(count)]
    return ''.join(f'f {hub} {b} {a}\n' if turned else f'f {hub} {a} {b}\n' for a, b in pairs)


def fan(count):
    return 'v 0 0 0\n' + ring(count, 0) + around(count, 1, 2)


def cone(count):
    return 'v 0 0 1\nv 0 0 0\n' + ring(count, 0) + around(count, 1, 3) + around(count, 2, 3, True)


def two_cones(count):
    return ('v 0 0 0\nv 0 0 1\nv 0 0 -1\n' + ring(count, 1) + ring(count, -1) + around(count, 1, 4, True) + around(count, 2, 4) +
            around(count, 1, 4 + count) + around(count, 3, 4 + count, True))


def book(count):
    return 'v 0 0 0\nv 0 0 1\n' + ring(count, 0.5) + ''.join(f'f 1 2 {i + 3}\n' for i in range(count))


def hanging(count):
    """A square whose lower side has that many vertices of the strip below it."""
    at = [i / (count + 1) for i in range(count + 2)]
    top = [1, *range(5, 5 + count), 2]
    below = 5 + count
    return ('v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n' + ''.join(f'v {x!r} 0 0\n' for x in at[1:-1]) + ''.join(f'v {x!r} -1 0\n' for x in at) +
            'f 1 2 3 4\n' + ''.join(f'f {below + i} {below + i + 1} {top[i + 1]} {top[i]}\n' for i in range(count + 1)))


@attack_each({'fan': (fan, 20000), 'shell of a fan': (fan, 10000, '--shell'), 'cone': (cone, 25000), 'two cones': (two_cones, 5000),
              'around an edge': (book, 10000), 'hanging vertices': (hanging, 5000),
              'hanging vertices, split': (hanging, 2000, '--tolerance', '5%')})
def around_one_place(place, case):
    """All pairs of boxes of such triangles meet."""
    shape, count, *more = case
    place.file('hub.obj', shape(part(place, count)))
    place.ended_well(place.run('hub.obj', 'out.obj', '-d', '0.05', *more), 0)


@attack
def joined_lines(place):
    place.file('joined.obj', BOX + 'l 1 ' + '\\\n' * 1000000 + '2\n')
    place.ended_well(place.run('joined.obj', 'out.obj', '-d', '0.1'), 0)


@attack
def curves_from_one_point(place):
    count = part(place, 15000)
    spokes = range(count)
    place.file('hub.obj', 'v 0 0 0\n' + ''.join(
        f'v {math.cos(2 * math.pi * i / count):.9g} {math.sin(2 * math.pi * i / count):.9g} 0\n' for i in spokes) +
        ''.join(f'l 1 {i + 2}\n' for i in spokes))
    place.ended_well(place.run('hub.obj', 'out.obj', '-d', '1%'), 0)


def drawing(paths, size):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}" height="{size}" viewBox="0 0 {size} {size}">\n' +
            ''.join(f'<path d="{path}"/>\n' for path in paths) + '</svg>\n')


def circle(x, y, radius):
    return 'M' + 'L'.join(f'{x + radius * math.cos(2 * math.pi * i / 64):.6f} {y + radius * math.sin(2 * math.pi * i / 64):.6f}'
                          for i in range(64)) + 'Z'


@attack
def circles_through_one_point(place):
    count = part(place, 200)
    turns = [2 * math.pi * i / count for i in range(count)]
    place.file('rose.svg', drawing([circle(500 + 100 * math.cos(a), 500 + 100 * math.sin(a), 100) for a in turns], 1000))
    place.ended_well(place.run('rose.svg', 'out.svg', '-d', '1'), 0)


@attack
def circles_in_each_other(place):
    count = part(place, 400)
    place.file('rings.svg', drawing([circle(500, 500, 400 * (i + 1) / count) for i in range(count)], 1000))
    place.ended_well(place.run('rings.svg', 'out.svg', '-d', '0.2'), 0)


@attack_each({'one path': True, 'paths': False})
def many_triangles(place, in_one):
    count = part(place, 100000 if in_one else 50000)
    wide = math.isqrt(count)
    each = [f'M{3 * (i % wide)} {3 * (i // wide)}h1l-1 1Z' for i in range(count)]
    place.file('triangles.svg', drawing([''.join(each)] if in_one else each, 3 * wide + 9))
    place.ended_well(place.run('triangles.svg', 'out.svg', '-d', '0.1'), 0)


@attack_each({'level': 0, 'tilted': 0.37})
def points_on_one_line(place, slope):
    """Each place is on a third of the segments. What has fewer crossings than are counted has them listed, which takes
    longer than that, so that a tenth of the points would be no less work: sanitized, there are few."""
    numbers = random.Random(1)
    at = [numbers.random() for _ in range(250 if place.sanitized else 6250)]
    place.file('line.txt', ''.join(f'{x!r} {slope * x!r}\n' for x in at))
    place.ended_well(place.run('line.txt', 'out.txt', '-d', '1%'), 0)


@attack
def teeth_out_of_order(place):
    """Boxes around segments in a row hold a third of the others."""
    count = part(place, 6000)
    place.file('zigzag.txt', ''.join(f'{i * 4943 % count / count * 10:.9g} {i % 2 * 10}\n' for i in range(count)))
    place.ended_well(place.run('zigzag.txt', 'out.txt', '-d', '1%'), 0)


@attack
def to_and_fro(place):
    place.file('fro.txt', '0 0\n1 0\n' * 50000)
    # A vertex has no side to go to: none reaches the distance.
    place.ended_well(place.run('fro.txt', 'out.txt', '-d', '0.1'), 3)


@attack
def triangles_that_all_meet(place):
    """Triangles around one point: more than a million pairs, which is as many as are counted."""
    numbers = random.Random(1)
    lines = []
    count = part(place, 1500)
    for _ in range(count):
        u, v = ([numbers.gauss(0, 1) for _ in range(3)] for _ in range(2))
        for angle in (0, 2.1, 4.2):
            lines.append('v ' + ' '.join(f'{a * math.cos(angle) + b * math.sin(angle):.9g}' for a, b in zip(u, v)) + '\n')
    lines += [f'f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n' for i in range(count)]
    place.file('soup.obj', ''.join(lines))
    run = place.run('soup.obj', 'out.obj', '-d', '1%')
    place.ended_well(run, 0)
    place.check(place.sanitized or b'more than 1000000 triangle pairs' in run.err + run.out,
                'expected to be told of them', run)


@attack_each({'topology': (), 'iso': ('--mode', 'iso')})
def far_away(place, more):
    """A double has an eighth of a unit there."""
    place.file('far.obj', sphere(1e15))
    place.refused(place.run('far.obj', 'out.obj', '-d', '10%', *more), 2, 'rounded by .* got 0.111')
    place.check(place.names() == ['far.obj'], 'expected no other file')


@attack
def few_digits(place):
    place.file('sphere.obj', sphere(0))
    run = place.run('sphere.obj', 'out.obj', '--mode', 'iso', '-d', '2%', '--precision', '1')
    place.refused(run, 2, 'rounded by .* got 0.5')


@attack_each({'percent': '1%', 'little': '0.000001%', 'length': '1e-321'})
def tiny(place, distance):
    place.file('tiny.obj', ''.join(line.replace('1', '1e-320') + '\n' if line.startswith('v') else line + '\n'
                                   for line in BOX.splitlines()))
    place.refused(place.run('tiny.obj', 'out.obj', '-d', distance), 2, 'expected')
