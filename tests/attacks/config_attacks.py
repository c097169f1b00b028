# SPDX-License-Identifier: Apache-2.0
"""Files of options that are none, or that say what no option takes."""
import os

from attack import attack, attack_each

ONE = ('box.obj', 'o.obj', '--config', 'all.toml')

# What the file holds, the exit code, and what is said.
FILES = {
    'no option': ('distance = 0.1\n\nshells = 1\n', 1, "^vdb_offset: all.toml:3: expected the long name of an option, got 'shells'$"),
    'short name': ('d = 0.1\n', 1, "all.toml:1: expected the long name of an option, got 'd'"),
    'dashes': ('"--distance" = 0.1\n', 1, "all.toml:1: expected the long name of an option, got '--distance'"),
    'itself': ('config = "all.toml"\n', 1, "got 'config'"),
    'help': ('help = true\n', 1, "got 'help'"),
    'position': ('INPUT = "other.obj"\ndistance = 1\n', 1, "got 'INPUT'"),
    'flag with a value': ('distance = 1\nstrict = "yes"\n', 1, 'all.toml:2: strict: expected true or false'),
    'value that is none': ('distance = true\n', 1, 'all.toml:1: distance: expected a value, not true or false'),
    'empty value': ('distance = ""\n', 1, "expected a value, got ''"),
    'wrong value': ('distance = 1\ncorners = "bevel"\n', 1, "--corners: expected 'miter', 'round' or 'arc', got 'bevel'"),
    'twice': ('distance = 1\ndistance = 2\n', 1, 'all.toml:2: expected TOML'),
    'several of one': ('distance = 1\ncorners = ["round", "miter"]\n', 1, '--corners'),
    'lists in lists': ('distance = [[1, 2]]\n', 1, 'all.toml:1: expected a string, a number, true, false or an array'),
    'table': ('[distance]\nxy = 1\n', 1, 'all.toml:1: expected a string, a number'),
    'date': ('distance = 2026-11-26\n', 1, 'all.toml:1: expected a string, a number'),
    'infinite': ('distance = inf\n', 1, 'distance'),
    'no TOML': ('distance: 1%\n', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'not text': (b'distance = "\xff\xfe"\n', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'zeros': (b'\0' * 4096, 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'deep': ('distance = ' + '[' * 100000 + '\n', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'deep key': ('a.' * 100000 + 'a = 1\n', 1, '^vdb_offset: all.toml:1: expected TOML: a key of at most 64 parts$'),
    'deep key in quotes': ('distance = 1\n' + '"a".' * 100000 + 'a = 1\n', 1, 'all.toml:2: expected TOML: a key of at most'),
    'deep key with blanks': ("a . 'b' . " * 50000 + 'a = 1\n', 1, 'all.toml:1: expected TOML: a key of at most'),
    'deep key in a table': ('x = { ' + 'a.' * 100000 + 'a = 1 }\n', 1, 'all.toml:1: expected TOML: a key of at most'),
    'deep table': ('[' + 'a.' * 100000 + 'a]\n', 1, 'all.toml:1: expected TOML: a key of at most'),
    'deep tables': ('[[' + 'a.' * 100000 + 'a]]\n', 1, 'all.toml:1: expected TOML: a key of at most'),
    'deep inline tables': ('x = ' + '{ a = ' * 100000, 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'key in many lines': ('a.\n' * 100000, 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'long key': ('a' * 100000 + ' = 1\n', 1, '^vdb_offset: all.toml:1: expected the long name of an option, got one of 100000'),
    'hosts': ('distance = 0.1\nsshlogin = "node"\n', 1, '^vdb_offset: all.toml:2: sshlogin: expected on the command line alone'),
    'letters for spaces': ('distanceä=д 1\n', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'letters behind a value': ('distance = 1 д\n', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'a table without a name': ('[ = 1\n', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'a date that goes on': ('a.b.c = 1979-05-27T09:32:00.5-КӚ\n', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'a name cut by zero': ('distance = 0.1\nreport = "o.obj\\u0000x"\n', 1, 'all.toml:2: expected text without characters of code 0'),
    'zero in a list': ('distance = ["0.1", "0.2\\u0000"]\n', 1, 'all.toml:1: expected text without characters of code 0'),
    'cut': ('distance = "1', 1, '^vdb_offset: all.toml:1: expected TOML: '),
    'large': ('# a\n' * 1000000, 1, 'all.toml: expected a file of options .TOML., got more than'),
    'several lines': ('distance = """1\n2"""\n', 1, 'distance'),
}


@attack_each(FILES)
def file_of_options(place, case):
    text, code, says = case
    place.box()
    place.file('all.toml', text)
    place.refused(place.run(*ONE), code, says)


HOSTS = ['node;touch PWN', 'node\ntouch PWN', '$(touch PWN)', '`touch PWN`', 'ssh node', '-oProxyCommand=touch PWN', '..',
         '@group', '1/ssh -l x node', 'a b', '', 'node,', ',node', 'node:', 'node:x', 'x@', '@node', 'x@@node', '/node', 'n/node',
         '1//node', 'node/1', 'node|touch PWN', "node'", 'no"de', 'node\\', 'node#', '~/hosts', '/etc/hosts', '100000/node']


@attack_each({host: host for host in HOSTS})
def machines_that_are_words_of_a_shell(place, host):
    place.box('in/box.obj')
    place.refused(place.run('batch', 'in', 'out', '-d', '0.1', '--sshlogin', host), 1, '--sshlogin: expected|expected a value|required')
    place.file('house.toml', f'distance = 0.1\nsshlogin = {host!r}\n' if "'" not in host and '\n' not in host and '\\' not in host
               else 'sshlogin = "node;touch PWN"\n')
    place.refused(place.run('batch', 'in', 'out', '--config', 'house.toml'), 1, 'sshlogin: expected on the command line alone')
    place.check('PWN' not in place.names(), 'a file of options ran a command')


PARTITIONS = ['a b', 'a;touch PWN', '-x', 'a\nb', '$(x)', '', 'a,,b', '--wrap=touch PWN']


@attack_each({name: name for name in PARTITIONS})
def partitions_that_are_none(place, name):
    place.box('in/box.obj')
    place.refused(place.run('batch', 'in', 'out', '-d', '0.1', f'--slurm={name}'), 1, '--slurm: expected|--slurm: 1 required')
    place.check('PWN' not in place.names(), 'a partition ran a command')


# Names of models that a spreadsheet would take for formulas.
@attack_each({name: name for name in ('=1+1.obj', '+1.obj', '-1.obj', '@x.obj', '\tx.obj', "=cmd|'x'!A1.obj")})
def names_that_are_formulas(place, name):
    place.box('in/' + name)
    place.ended_well(place.run('batch', 'in', 'out', '-d', '0.1'), 0)
    row = (place.folder / 'out/batch.csv').read_text().split('\n')[1]
    shown = '\\x09x.obj' if name.startswith('\t') else "'" + name
    place.check(row.startswith('"' + shown), f'expected a text, got {row}')


@attack
def distances_that_are_formulas(place):
    place.box('in/box.obj')
    place.ended_well(place.run('batch', 'in', 'out', '-d', '-1%', '--distance=-(0.01)+0*x', '--output', '{model}_{i}.obj'), 0)
    rows = (place.folder / 'out/batch.csv').read_text().split('\n')
    place.check(rows[1].startswith('"box.obj",-1%,') and rows[2].startswith('"box.obj",\'-(0.01)+0*x,'), f'got {rows}')


@attack
def table_that_is_a_pipe(place):
    place.box('in/box.obj')
    place.file('out/x', '')
    os.mkfifo(place.folder / 'out/batch.csv')
    place.refused(place.run('batch', 'in', 'out', '-d', '0.1'), 4, 'batch.csv: expected a file that can be replaced')


@attack
def no_file_of_options(place):
    place.box()
    for path in ('nowhere.toml', '.', '/dev/zero', ''):
        place.refused(place.run('box.obj', 'o.obj', '-d', '1', '--config', path), 1 if path in ('/dev/zero', '') else 2,
                      'expected a file of options|expected a value')


@attack
def what_a_file_says_counts_after_the_command_line(place):
    place.box()
    place.file('all.toml', 'distance = [0.1, 0.2] # two\nstrict = false\nquiet = true\nreport = "r_{i}#.json"\n')
    place.ended_well(place.run(*ONE), 0)
    place.check(place.names() == ['all.toml', 'box.obj', 'o_001.obj', 'o_002.obj', 'r_001#.json', 'r_002#.json'],
                'expected two outputs and reports')
    place.ended_well(place.run(*ONE, '--distance', '0.3', '--report', 'one.json'), 0)
    place.check('o.obj' in place.names() and 'one.json' in place.names(), 'expected one output and report')


@attack
def what_the_line_says_of_the_distance_counts_for_all_that_the_file_says(place):
    place.box()
    place.file('all.toml', 'distance = 0.1\nreports = true\noutput = "{model}.ply"\nstrict = true\n')
    place.ended_well(place.run(*ONE), 0)
    place.ended_well(place.run(*ONE, '--distance-xy', '0.1', '--distance-z', '0.2', '--strict=false'), 0)
    place.check(place.names() == ['all.toml', 'box.obj', 'o.obj'], 'expected that what is for batch is passed over')


@attack
def a_batch_spares_its_file_of_options(place):
    place.box('in/a.obj')
    for path, name in (('out/a.obj', 'out/a.obj'), ('out/a.json', 'house.toml')):
        text = 'distance = 0.1\n'
        place.file(path if name == path else 'house.toml', text)
        if name != path:
            (place.folder / path).unlink(missing_ok=True)
            os.link(place.folder / name, place.folder / path)
        place.refused(place.run('batch', 'in', 'out', '--config', name, '--report', '{model}.json'), 1,
                      'a.obj: its output .* would replace the file of --config')
        place.check((place.folder / name).read_text() == text, 'expected the file of options as it was')
        (place.folder / path).unlink()
    place.file('out/batch.csv', 'distance = 0.1\n')
    place.refused(place.run('batch', 'in', 'out', '--config', 'out/batch.csv'), 1, 'expected another file than the table')


@attack
def a_batch_spares_what_other_models_read(place):
    for name in ('a', 'a_x'):
        place.box(f'in/{name}.obj')
        place.file(f'in/{name}.txt', '0.1\n' * 8)
    place.refused(place.run('batch', 'in', '.', '--distance-from', '{model}.txt', '--output', 'o/{model}.ply', '--report', 'in/{model}_x.txt'),
                  1, 'a.obj: its output .*a_x.txt would replace a file that the batch reads')
    os.makedirs(place.folder / 'out')
    os.symlink('../in/a.obj', place.folder / 'out/batch.csv')
    before = (place.folder / 'in/a.obj').read_bytes()
    place.refused(place.run('batch', 'in', 'out', '-d', '0.1'), 1, 'batch.csv: expected a table, got a file that is read')
    place.check((place.folder / 'in/a.obj').read_bytes() == before, 'expected the model as it was')
