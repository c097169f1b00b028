# SPDX-License-Identifier: Apache-2.0
"""Names of files and options that are long, odd, or not text."""
from attack import attack


@attack
def long_path(place):
    place.refused(place.run('😀' * 4000 + '.obj', 'out.obj', '-d', '0.1'), 2, 'cannot be opened|cannot be read|too long')
    place.check(place.names() == [], 'expected no file')
