# SPDX-License-Identifier: Apache-2.0
"""Files of OpenVDB's grids that are damaged. OpenVDB trusts what it reads. Sanitized, the child that tries a file says what
OpenVDB does there, which is no fault of the command: damaged files are left out."""
import pathlib
import random

from attack import attack, attack_each


def grid(place):
    """The bytes of a level set."""
    place.box('box.obj')
    place.ended_well(place.run('box.obj', 'whole.vdb', '-d', '0.1', '--mode', 'iso', '--voxel-size', '0.1'), 0)
    return pathlib.Path(place.folder, 'whole.vdb').read_bytes()


def tried(place, content):
    """Read, or refused in one line and with no output."""
    if place.sanitized:
        return
    place.file('damaged.vdb', content)
    run = place.run('damaged.vdb', 'out.obj', '-d', '0.05', '-q', '--max-memory', '1G')
    place.check(run.code in (0, 2, 3), 'expected to be read or refused', run)
    if run.code != 2:
        pathlib.Path(place.folder, 'out.obj').unlink(missing_ok=True)
        return
    place.refused(run, 2, 'damaged.vdb')
    place.check('out.obj' not in place.names(), 'expected no output', run)


@attack
def grids_cut_short(place):
    whole = grid(place)
    for size in [*range(1, 64, 7), *range(64, len(whole), len(whole) // 16)]:
        tried(place, whole[:size])


@attack_each({'header': 0.02, 'nodes': 0.2, 'anywhere': 1})
def grids_with_other_bits(place, share):
    whole = grid(place)
    numbers = random.Random(int(100 * share))
    for _ in range(25):
        damaged = bytearray(whole)
        for _ in range(4):
            damaged[numbers.randrange(max(200, int(share * len(damaged))))] ^= 1 << numbers.randrange(8)
        tried(place, bytes(damaged))


@attack
def no_grids(place):
    place.file('text.vdb', b'v 0 0 0\n' * 100)
    place.refused(place.run('text.vdb', 'out.obj', '-d', '0.1'), 2, 'text.vdb: expected a file that OpenVDB reads')
    place.box('box.obj')
    place.refused(place.run('box.obj', 'out.vdb', '-d', '0.1'), 1, 'out.vdb: expected --mode iso')
    place.refused(place.run('box.obj', 'out.obj', '-d', '0.1', '--grid', 'phi'), 1, 'that ends in .vdb')
