# SPDX-License-Identifier: Apache-2.0
"""Signals: any phase ends at once, by the signal, and every output is as it was before, or complete."""
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import time

from attack import attack, attack_each
import models

OLD = b'as it was before'

# What is written, and the files that it makes.
KINDS = {
    'obj': (['m.obj', 'o.obj', '-d', '2%'], ['o.obj']),
    'stl': (['m.obj', 'o.stl', '-d', '2%'], ['o.stl']),
    'gz': (['m.obj', 'o.ply.gz', '-d', '2%'], ['o.ply.gz']),
    'several': (['m.obj', 'o{i}.ply', '-d', '1%', '-d', '2%', '-d', '3%', '--report', 'r{i}.json', '--states', 's{i}.csv'],
                [f'{name}00{i}.{ending}' for i in (1, 2, 3) for name, ending in (('o', 'ply'), ('r', 'json'), ('s', 'csv'))]),
    'everything': (['m.obj', 'o.off', '-d', '2%', '--report', 'r.json', '--states', 's.ply', '--paths', 'p.obj',
                    '--save-vdb', 'f.vdb'], ['o.off', 'r.json', 's.ply', 'p.obj', 'f.vdb']),
    'shell': (['m.obj', 'o.obj', '-d', '2%', '--shell', '--report', 'r.json'], ['o.obj', 'r.json']),
    'iso': (['m.obj', 'o.stl', '-d', '2%', '--mode', 'iso', '--voxel-size', '0.05', '--report', 'r.json'], ['o.stl', 'r.json']),
    'surfaces': (['m.obj', 'l{i}.obj', '--layers', '4', '--total-thickness', '3%', '--report', 'r.json'],
                 ['l001.obj', 'l002.obj', 'l003.obj', 'l004.obj', 'r.json']),
    **{kind: (['m.obj', 'o.' + kind, '--layers', '8', '--total-thickness', '5%', '--report', 'r.json'], ['o.' + kind, 'r.json'])
       for kind in ('vtu', 'msh', 'su2', 'cgns')},
    'foam': (['m.obj', 'constant/polyMesh', '--layers', '8', '--total-thickness', '5%', '--report', 'r.json'],
             ['r.json'] + ['constant/polyMesh/' + name for name in ('points', 'faces', 'owner', 'neighbour', 'boundary')]),
    'block': (['c.txt', 'o.vts', '--layers', '80', '--total-thickness', '0.1', '--structured'], ['o.vts']),
    'check': (['check', 'm.obj', 'm.obj', '-d', '0', '--report', 'r.json', '--states', 's.csv', '--html', 'p.html'],
              ['r.json', 's.csv', 'p.html']),
    'view': (['view', 'm.obj', 'm.obj', '-d', '0', '--no-open', '--html', 'p.html'], ['p.html']),
    'curves': (['c.txt', 'o.svg', '-d', '0.01', '--report', 'r.json'], ['o.svg', 'r.json']),
}
KILLS = int(os.environ.get('VDB_OFFSET_KILLS', 14))  # of each kind


def make_inputs(place):
    place.file('m.obj', models.sphere(60, 40))
    place.file('c.txt', models.circle(4000))


def put_old(place, outputs):
    for name in outputs:
        place.file(name, OLD)


def states(place, outputs):
    """Of each output, whether it is as before."""
    return [(place.folder / name).read_bytes() == OLD for name in outputs]


def content(place, name):
    """All that is the same from run to run."""
    data = (place.folder / name).read_bytes()
    if name.endswith('json'):
        return sorted(json.loads(data))
    return len(data) if name.endswith(('vdb', 'cgns')) else data


def contents(place, outputs):
    return {name: content(place, name) for name in outputs}


@attack_each(KINDS)
def killed_at_any_moment(place, kind):
    arguments, outputs = kind
    make_inputs(place)
    began = time.monotonic()
    whole = place.run(*arguments)
    place.check(whole.code in (0, 3), 'expected a whole run', whole)
    code, length, right = whole.code, time.monotonic() - began, contents(place, outputs)
    names = place.names()
    place.check(all(name in names for name in outputs), f'expected {outputs}, got {names}')
    chance = random.Random(' '.join(arguments))
    for i in range(2 if place.sanitized else KILLS):
        by = [signal.SIGTERM, signal.SIGINT, signal.SIGKILL, signal.SIGHUP, signal.SIGKILL][i % 5]
        put_old(place, outputs)
        before = set(place.names())  # also what SIGKILL has left
        process = place.start(*arguments)
        # Half of them while outputs are written.
        time.sleep(length * (chance.uniform(0, 1.05) if i % 2 else chance.uniform(0.7, 1.02)))
        place.end(process, by)
        old = states(place, outputs)
        place.check(process.returncode in (code, -by), f'{by.name}: exit {process.returncode}')
        if by != signal.SIGKILL:
            place.check(all(old) if process.returncode < 0 else not any(old),
                        f'{by.name}, exit {process.returncode}: as before: {dict(zip(outputs, old))}')
            place.check(set(place.names()) <= before, f'{by.name}: left {set(place.names()) - before}')
        for name, is_old in zip(outputs, old):
            place.check(is_old or content(place, name) == right[name], f'{by.name}: {name} is not complete')
    last = place.run(*arguments)
    place.check(last.code == code and place.names() == names, f'left {set(place.names()) - set(names)}', last)
    place.check(contents(place, outputs) == right, 'expected the same outputs again')


@attack
def folders_made_go_again(place):
    """A killed run that has made folders takes them along."""
    make_inputs(place)
    arguments = ['m.obj', 'a/b/polyMesh', '--layers', '8', '--total-thickness', '5%']
    began = time.monotonic()
    place.ended_well(place.run(*arguments), 0)
    length = time.monotonic() - began
    for share in (0.6, 0.7, 0.8, 0.85, 0.9, 0.95):
        shutil.rmtree(place.folder / 'a')
        process = place.start(*arguments)
        time.sleep(length * share)
        process.terminate()
        process.communicate()
        names = [name for name in place.names() if name.startswith('a')]
        if process.returncode < 0:
            place.check(names == [], f'left {names}')
            place.file('a/x')
        else:
            place.check(len(names) == 8, f'{names}')


DEAF = {
    'a scene being built': lambda place: (place.file('s.json', json.dumps(
        {'shape': {'type': 'icosphere', 'radius': 1, 'subdivisions': 9}, 'offset': {'distance': 0.1}})).name,),
    'a fifo with no writer': lambda place: (os.mkfifo(place.folder / 'f.obj') or 'f.obj',),
    'heights from a fifo': lambda place: (os.mkfifo(place.folder / 'h.txt') or place.box().name,),
    'continuation lines': lambda place: (place.file('l.obj', 'v 0 0 0 ' + '\\\n' * 30000000).name,),
}


@attack
def a_writer_that_says_nothing(place):
    """A pipe whose writer keeps it open in the middle of a mesh."""
    os.mkfifo(place.folder / 'f.obj')
    process = place.start('f.obj', 'o.obj', '-d', '0.1')
    with open(place.folder / 'f.obj', 'wb') as writer:
        writer.write(b'v 0 0 0\n')
        writer.flush()
        time.sleep(0.3)
        place.end(process, signal.SIGTERM)
    place.check(process.returncode == -signal.SIGTERM, f'exit {process.returncode}')
    place.check(place.names() == ['f.obj'], f'left {place.names()}')


@attack_each(DEAF)
def nothing_is_deaf(place, make):
    source, = make(place)
    more = ['--layers', '3', '--heights', 'h.txt'] if (place.folder / 'h.txt').exists() else ['-d', '0.1']
    process = place.start(source, 'o.obj', *more)
    time.sleep(0.5 if not place.sanitized else 2)
    place.check(process.poll() is None, 'expected it to be at it still')
    place.end(process, signal.SIGTERM)
    place.check(process.returncode == -signal.SIGTERM, f'exit {process.returncode}')


@attack
def nobody_reads(place):
    """An output pipe that closes early is an error of writing, and leaves nothing behind."""
    make_inputs(place)
    reading, writing = os.pipe()
    process = place.start('m.obj', '-', '--format', 'obj', '-d', '1%', '--report', 'r.json', stdout=writing)
    os.close(writing)
    os.read(reading, 100)
    os.close(reading)
    process.communicate()
    place.check(process.returncode == 4, f'exit {process.returncode}')
    place.check(place.names() == ['c.txt', 'm.obj'], f'left {place.names()}')


@attack
def ignored_signals_stay_so(place):
    """As with nohup."""
    make_inputs(place)
    process = place.start('m.obj', 'o.obj', '-d', '1%', before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    time.sleep(0.1)
    process.send_signal(signal.SIGHUP)
    process.communicate()
    place.check(process.returncode == 0, f'exit {process.returncode}')


def children_of(process):
    """Numbers of the processes that it has begun."""
    try:
        return [int(child) for child in pathlib.Path(f'/proc/{process.pid}/task/{process.pid}/children').read_text().split()]
    except OSError:  # it has ended
        return []


@attack
def a_model_of_a_batch_is_killed(place):
    """What is killed in a batch leaves nothing beside its outputs."""
    place.file('in/m.obj', models.sphere(60, 40))
    arguments = ['batch', 'in', 'out', '-d', '2%', '--states', '{model}.csv', '--save-vdb', '{model}.vdb', '--retry-failed']
    began = time.monotonic()
    place.ended_well(place.run(*arguments), 0)
    length, names = time.monotonic() - began, place.names()
    chance = random.Random(1)
    for _ in range(2 if place.sanitized else KILLS):
        shutil.rmtree(place.folder / 'out')
        process = place.start(*arguments)
        time.sleep(chance.uniform(0.5, 1) * length)
        for child in children_of(process):
            os.kill(child, signal.SIGKILL)
        process.communicate(timeout=60)
        place.check(process.returncode in (0, 3), f'exit {process.returncode}')
        left = set(place.names()) - set(names)
        place.check(not left, f'left {left}')
    place.ended_well(place.run(*arguments), 0)
    place.check(place.names() == names, f'expected {names}, got {place.names()}')


@attack_each({'ended': signal.SIGTERM, 'interrupted': signal.SIGINT, 'killed': signal.SIGKILL})
def batches_killed_at_any_moment(place, by):
    """A batch that ends goes on where it was, and every output is complete or not there."""
    for i in range(3):
        place.file(f'in/{i}.obj', models.sphere(40, 30))
    arguments = ['batch', 'in', 'out', '-d', '2%']
    began = time.monotonic()
    place.ended_well(place.run(*arguments), 0)
    length, outputs = time.monotonic() - began, [f'out/{i}.obj' for i in range(3)]
    right = contents(place, outputs)
    chance = random.Random(int(by))
    for _ in range(2 if place.sanitized else KILLS):
        shutil.rmtree(place.folder / 'out', ignore_errors=True)
        process = place.start(*arguments)
        time.sleep(chance.uniform(0, 1.05) * length)
        place.end(process, by)
        for name in outputs:
            place.check(not (place.folder / name).exists() or content(place, name) == right[name], f'{name} is not complete')
        place.ended_well(place.run(*arguments), 0)
        place.check(contents(place, outputs) == right, 'expected the outputs of a batch that nobody disturbed')
