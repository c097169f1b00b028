# SPDX-License-Identifier: Apache-2.0
"""Compressed files that are damaged, cut, or hold far more than they seem to."""
import struct
import zlib

from attack import attack, attack_each
from hostile import OBJ, accepted, gzipped, refused, says

TEXT = OBJ.encode()
PACKED = gzipped(TEXT)


def flipped(data, at, bits=0x40):
    return data[:at] + bytes([data[at] ^ bits]) + data[at + 1:]


def zstd_block(content, last=True, kind=0, size=None):
    """Raw (0), or one byte over and over (1)."""
    return struct.pack('<I', (len(content) if size is None else size) << 3 | kind << 1 | last)[:3] + content


def zstd(*blocks, descriptor=0x20, size=len(TEXT), magic=0xfd2fb528, end=b''):
    """A frame of a single segment whose size (one byte, or four with 0xa0) is told."""
    told = struct.pack('<I', size) if descriptor >> 6 == 2 else bytes([size & 255])
    return struct.pack('<I', magic) + bytes([descriptor]) + told + b''.join(blocks or (zstd_block(TEXT),)) + end


GOOD = zstd()
SKIPPED = struct.pack('<II', 0x184d2a50, 5) + b'12345'

# What is damaged is told by the byte; what is behind is a message of the library.
GZIP = {
    'as it is': (PACKED, 4),
    'empty': (b'', 'byte 0', 'the end of the gzip data', 'the end of the file'),
    'zstd': (GOOD, r'byte \d+', 'gzip data', 'incorrect header check'),
    **{f'cut at {n}': (PACKED[:n], f'byte {n}', 'the end of the gzip data', 'the end of the file') for n in (1, 30)},
    'cut before the length': (PACKED[:-1], f'byte {len(PACKED) - 1}', 'the end of the gzip data', 'the end of the file'),
    'a wrong checksum': (flipped(PACKED, len(PACKED) - 8), r'byte \d+', 'gzip data', 'incorrect data check'),
    'a wrong length': (flipped(PACKED, len(PACKED) - 1), r'byte \d+', 'gzip data', 'incorrect length check'),
    'an unknown method': (flipped(PACKED, 2, 4), r'byte \d+', 'gzip data', 'unknown compression method'),
    'unknown flags': (flipped(PACKED, 3, 0xe0), r'byte \d+', 'gzip data', 'unknown header flags'),
    'a wrong block': (PACKED[:10] + b'\7' + PACKED[11:], r'byte \d+', 'gzip data', 'invalid block type'),
    'bytes behind': (PACKED + b'more', r'byte \d+', 'gzip data', 'incorrect header check'),
    'two members': (gzipped(TEXT[:20]) + gzipped(TEXT[20:]), 4),
    'a second member cut': (PACKED + PACKED[:20], f'byte {len(PACKED) + 20}', 'the end of the gzip data',
                            'the end of the file'),
    'packed twice': (gzipped(PACKED), 'line 1', 'a line of an OBJ file', ''),
}
ZSTD = {
    'as it is': (GOOD, 4),
    'empty': (b'', r'byte \d+', 'the end of the zstd data|a mesh', ''),
    'not packed': (TEXT, r'byte \d+', 'zstd data', 'Unknown frame descriptor'),
    **{f'cut at {n}': (GOOD[:n], f'byte {n}', 'the end of the zstd data', 'the end of the file') for n in (3, 20)},
    'no last block': (zstd(zstd_block(TEXT, last=False)), f'byte {len(GOOD)}', 'the end of the zstd data',
                      'the end of the file'),
    'another size': (zstd(size=len(TEXT) + 1), r'byte \d+', 'zstd data', ''),
    'a block longer than may be': (zstd(zstd_block(b'x', kind=1, size=(1 << 21) - 1), descriptor=0xa0, size=(1 << 21) - 1),
                                   r'byte \d+', 'zstd data', ''),
    'a wrong checksum': (zstd(descriptor=0x24, end=b'1234'), r'byte \d+', 'zstd data', "doesn't match checksum"),
    'no checksum': (zstd(descriptor=0x24), r'byte \d+', 'the end of the zstd data', 'the end of the file'),
    'a dictionary': (zstd(descriptor=0x21), r'byte \d+', 'zstd data', ''),
    'a window of 2^41': (struct.pack('<I', 0xfd2fb528) + b'\0\xf8' + zstd_block(TEXT), r'byte \d+', 'zstd data',
                         'too much memory'),
    'bytes behind': (GOOD + b'more', r'byte \d+', 'zstd data', ''),
    'two frames': (zstd(zstd_block(TEXT[:20]), size=20) + zstd(zstd_block(TEXT[20:]), size=len(TEXT) - 20), 4),
    'a frame to skip': (SKIPPED + GOOD + SKIPPED, 4),
    'a frame to skip, longer than the file': (GOOD + SKIPPED[:-1], f'byte {len(GOOD + SKIPPED) - 1}',
                                              'the end of the zstd data', ''),
}


def attack_packed(kind, ending, cases):
    name = f'hostile.obj.{ending}'

    def check(place, case):
        if len(case) == 2:
            accepted(place, name, *case)
        else:
            refused(place, name, case[0], says(name, *case[1:]))
    check.__module__, check.__name__ = __name__, kind
    attack_each(cases)(check)


attack_packed('gzip', 'gz', GZIP)
attack_packed('zstd', 'zst', ZSTD)


@attack
def endings_alone(place):
    """The ending that says how it is packed, and none that says what."""
    for name, content in (('mesh.gz', PACKED), ('mesh.obj.gz.gz', gzipped(PACKED))):
        refused(place, name, content, 'expected an input that ends in', code=1)


@attack
def bombs(place):
    """64 MiB of blanks, in gzip 64 kB and in zstd 2 kB: they are no mesh, and are told so."""
    blanks = gzipped(b' ' * (1 << 26))
    block = zstd_block(b' ', last=False, kind=1, size=1 << 17)
    blocks = zstd(*[block] * 511, zstd_block(b' ', kind=1, size=1 << 17), descriptor=0xa0, size=1 << 26)
    for name, content in (('bomb.obj.gz', blanks), ('bomb.obj.zst', blocks)):
        place.file(name, content)
        run = place.run(name, 'out.obj', '-d', '0.1')
        place.refused(run, 2, says(name, 'line 1', "at least one face", 'the end'))
        place.check(place.sanitized or run.peak < 400 << 20, 'expected less memory', run)
