# SPDX-License-Identifier: Apache-2.0
"""Models that attacks begin with, as text of files."""
import math


def sphere(around, across, radius=1.0, centre=(0.0, 0.0, 0.0)):
    """A closed sphere of quadrilaterals and two fans, as OBJ."""
    lines, x, y, z = [], *centre
    lines.append(f'v {x!r} {y!r} {z + radius!r}')
    for j in range(1, across):
        theta = math.pi * j / across
        for i in range(around):
            phi = 2 * math.pi * i / around
            lines.append(f'v {x + radius * math.sin(theta) * math.cos(phi)!r} '
                         f'{y + radius * math.sin(theta) * math.sin(phi)!r} {z + radius * math.cos(theta)!r}')
    lines.append(f'v {x!r} {y!r} {z - radius!r}')

    def at(j, i):
        return 2 + (j - 1) * around + i % around

    last = 2 + (across - 1) * around
    for i in range(around):
        lines.append(f'f 1 {at(1, i)} {at(1, i + 1)}')
        for j in range(1, across - 1):
            lines.append(f'f {at(j, i)} {at(j + 1, i)} {at(j + 1, i + 1)} {at(j, i + 1)}')
        lines.append(f'f {last} {at(across - 1, i + 1)} {at(across - 1, i)}')
    return '\n'.join(lines) + '\n'


def circle(points, radius=1.0):
    """A closed curve, as text of coordinates."""
    angles = [2 * math.pi * i / points for i in range(points)]
    rows = [f'{radius * math.cos(a)!r} {radius * math.sin(a)!r}' for a in angles]
    return '\n'.join(rows + rows[:1]) + '\n'
