"""amiroctl operate on CAN of the kernel: an interface that goes down, comes back or goes away, a storm of frames, a clock that is
set back, a kill, a disk that is really full; and the examples in C. Frames that are lost are counted: candump and the black
box are the judges."""
import json
import os
import re
import signal
import subprocess
import tempfile
import time

from harness import Candump, Process, Vcan, as_nobody, check, equal, eventually, expect, sh
from tool import Robot, amiroctl, cansend, matches, send_as_fast_as_possible

REST = '0000000000000000'
# Times are those of a guest with one CPU, which six programs share.
HALT = {
    'name': 'halt', 'initial': 'driving', 'fall_back': 'halted',
    'settle': '400ms', 'retry': '500ms', 'reaction': '100ms', 'handling': '20ms',
    'configurations': [
        {'name': 'driving', 'streams': [{'topic': 'odometry', 'period': '100ms', 'priority': 'high'}]},
        {'name': 'halted', 'streams': [{'topic': 'odometry', 'period': '100ms', 'priority': 'high'}], 'commanders': [],
         'entry': [{'topic': 'motors', 'repeat': '100ms'}]},
    ],
    'monitors': [
        {'name': 'too_fast', 'when': 'odometry.velocity.x>0.03m/s'},
        {'name': 'down', 'when': {'bus_state': 'down'}},
        {'name': 'still', 'when': {'all': ['odometry.velocity.x<0.01m/s', {'not': {'bus_state': 'down'}}]}, 'for': '600ms'},
    ],
    'transitions': [
        {'from': 'driving', 'to': 'halted', 'when': 'too_fast'},
        {'from': 'driving', 'to': 'halted', 'when': 'down', 'precedence': 1},
        {'from': 'halted', 'to': 'driving', 'when': 'still'},
    ],
}


class Operator(Process):
    """amiroctl operate, once it has begun."""
    def __init__(self, context, folder, interface, *options, prefix=()):
        path = os.path.join(folder, 'halt.operator.json')
        with open(path, 'w') as file:
            json.dump(HALT, file)
        super().__init__(*prefix, context.amiroctl, '--bus', interface, 'operate', path, '--json', *options,
                         env=os.environ | {'XDG_RUNTIME_DIR': folder})
        self.seen = 0
        self.event('started')

    def events(self):
        return [json.loads(line) for line in self.stdout.splitlines(keepends=True) if line.endswith('\n')]

    def event(self, name, **facts):
        """The next event of that name with these facts."""
        found = []

        def comes():
            for number, event in enumerate(self.events()[self.seen:], self.seen):
                if event['event'] == name and all(event[fact] == value for fact, value in facts.items()):
                    self.seen = number + 1
                    found.append(event)
                    return True
            return self.process.poll() is not None
        eventually(comes, f'the event {name} {facts} (so far: {self.stdout.strip()})', 60)
        expect(found, f'the operator ended before {name} {facts}: {self.stderr}')
        return found[0]

    def count(self, words):
        """What its last line says of it."""
        match = re.search(rf'(\d+) {words}', self.stderr)
        return int(match[1]) if match else 0


def drive_fast(interface):
    """What is too fast for HALT, past the operator: the simulated robot needs a while to get there."""
    for _ in range(4):
        cansend('201#50C3000000000000', interface=interface)
        time.sleep(0.1)


@check('an operator goes on when its interface was down, and what could not be sent is counted')
def _(context):
    with tempfile.TemporaryDirectory() as folder, Vcan('vcan1') as interface, Robot(context, 'vcan1'), \
            Candump('vcan1') as log, Operator(context, folder, 'vcan1') as operator:
        eventually(lambda: any(frame.id == '502' for frame in log.frames()), 'odometry')
        interface.down()
        operator.event('bus_state', state='down')
        operator.event('switched', to='halted', cause='down')
        time.sleep(0.5)  # set points of rest are due meanwhile
        interface.up()
        operator.event('bus_state', state='active')
        back = len(log.frames())
        eventually(lambda: sum(frame.id == '001' for frame in log.frames()[back:]) > 2, 'set points of rest')
        operator.event('switched', to='driving', cause='still')
        equal(operator.stop(), 130, 'exit code')
        frames = log.finish()
        expect(operator.count('frames replaced by newer ones') > 0, f'nothing was replaced: {operator.stderr}')
        # Of those that waited none was sent twice: after the pause they are 100 ms apart again.
        rest = [frame.time for frame in frames[back:] if frame.id == '001' and frame.data == REST]
        expect(all(b - a > 0.02 for a, b in zip(rest, rest[1:-1])), f'set points of rest at {rest}')
        sent = sum(frame.id in ('001', '103') for frame in frames)
        expect(sent >= operator.count('frames sent'), f'{sent} frames were on the bus: {operator.stderr}')


@check('an interface that goes away ends an operator in words, and the next one goes on')
def _(context):
    with tempfile.TemporaryDirectory() as folder:
        box = os.path.join(folder, 'box')
        with Vcan('vcan1'), Robot(context, 'vcan1'):
            with Operator(context, folder, 'vcan1', '--black-box', box) as operator:
                eventually(lambda: amiroctl(context, '--bus', 'vcan1', 'operator', 'status',
                                            env=os.environ | {'XDG_RUNTIME_DIR': folder}), 'it answers')
                sh('ip', 'link', 'del', 'vcan1')
                equal(operator.wait(), 1, 'exit code')
                matches(operator.stderr, 'vcan1')
                operator.event('recorded')
                equal(len([name for name in os.listdir(box) if name.endswith('.black-box.log')]), 1, 'recordings')
        with Vcan('vcan1'), Robot(context, 'vcan1'), Candump('vcan1') as log, \
                Operator(context, folder, 'vcan1', '--black-box', box) as operator:
            eventually(lambda: any(frame.id == '502' for frame in log.frames()), 'odometry')
            drive_fast('vcan1')
            operator.event('switched', to='halted', cause='too_fast')
            equal(operator.stop(), 130, 'exit code')


@check('boards that an operator has lost are asked again within the bound when they are back')
def _(context):
    with tempfile.TemporaryDirectory() as folder, Vcan('vcan1'), Candump('vcan1') as log:
        with Robot(context, 'vcan1') as robot:
            operator = Operator(context, folder, 'vcan1')
            eventually(lambda: any(frame.id == '502' for frame in log.frames()), 'odometry')
            robot.send_signal(signal.SIGKILL)
            robot.wait()
        with operator:
            operator.event('asked_again', topic='odometry')
            operator.event('asked_again', topic='odometry')  # so that the silence is over, and `retry` is what counts
            before = len(log.frames())
            with Robot(context, 'vcan1'):
                back = time.time()  # its socket listens
                eventually(lambda: any(frame.id == '503' for frame in log.frames()[before:]), 'odometry again')
                equal(operator.stop(), 130, 'exit code')
            came = next(frame.time for frame in log.finish()[before:] if frame.id == '503')
            expect(operator.count('silent streams asked for again') >= 3, f'the count: {operator.stderr}')
            study, _ = amiroctl(context, 'operate', os.path.join(folder, 'halt.operator.json'), '--check', '--json')
            bound = json.loads(study)['configurations'][0]['streams'][0]['recovery']['at_most_ns'] * 1e-9
            if 'later than "reaction"' not in operator.stderr:  # the bounds do not hold for those steps
                expect(came - back <= bound, f'odometry is back {came - back:.3f} s after the boards: bound {bound:.3f} s')


@check('of a storm of frames an operator counts those that it lost, and guards the robot')
def _(context):
    count = 5_000
    with tempfile.TemporaryDirectory() as folder, Vcan('vcan1'), Robot(context, 'vcan1') as robot:
        os.chown(folder, 65534, 65534)
        # Without privileges its queue in the kernel is as short as the machine's default.
        operator = Operator(context, folder, 'vcan1', '--black-box', os.path.join(folder, 'box'), '--black-box-time', '60s',
                            prefix=as_nobody())
        with operator:
            storm(operator, robot, count)


def storm(operator, robot, count):
    """While it sleeps; then it reacts, and says what it has lost."""
    operator.send_signal(signal.SIGSTOP)
    robot.send_signal(signal.SIGSTOP)  # it takes none of the guest's CPU for the storm
    send_as_fast_as_possible('vcan1', count)
    operator.send_signal(signal.SIGCONT)
    operator.settle()
    robot.send_signal(signal.SIGCONT)
    drive_fast('vcan1')
    operator.event('switched', to='halted', cause='too_fast')
    recorded = operator.event('recorded')
    equal(operator.stop(), 130, 'exit code')
    eventually(lambda: os.path.exists(recorded['file']), 'the recording')
    with open(recorded['file']) as file:
        lines = file.read().splitlines()
    equal(len(lines), recorded['frames'], 'frames of the black box')
    kept = sum(' 608#' in line for line in lines)
    lost = operator.count('frames lost')
    expect(lost > 0, f'nothing was lost, so that nothing is tried: {operator.stderr}')
    # While both slept the robot's own frames were lost, too.
    expect(count <= kept + lost <= count + 200, f'{kept} of {count} frames were kept, {lost} are counted as lost')


@check('an operator loses nothing of its black box when the clock is set back')
def _(context):
    with tempfile.TemporaryDirectory() as folder, Vcan('vcan1'), Robot(context, 'vcan1'), Candump('vcan1') as log, \
            Operator(context, folder, 'vcan1', '--black-box', os.path.join(folder, 'box'),
                     '--black-box-time', '60s') as operator:
        cansend('608#0000000000A1', interface='vcan1')
        time.sleep(1)  # this much of the box is before the clock is set
        now = time.time()
        time.clock_settime(time.CLOCK_REALTIME, now - 3600)
        try:
            cansend('608#0000000000A2', interface='vcan1')
            time.sleep(1)  # and this much behind it
            drive_fast('vcan1')
            operator.event('switched', to='halted', cause='too_fast')
            recorded = operator.event('recorded')
            operator.event('switched', to='driving', cause='still')
            operator.send_signal(signal.SIGKILL)  # the file that is written all the time must have it, too
            operator.wait()
            with Operator(context, folder, 'vcan1', '--black-box', os.path.join(folder, 'box')) as again:
                recovered = [event for event in again.events() if event['event'] == 'recovered'][0]
                equal(again.stop(), 130, 'exit code')
        finally:
            time.clock_settime(time.CLOCK_REALTIME, time.time() + 3600)
        with open(recorded['file']) as file:
            lines = file.read().splitlines()
        equal(len(lines), recorded['frames'], 'frames of the black box')
        times = [float(re.match(r'\((\d+\.\d+)\)', line)[1]) for line in lines]
        back = [number for number in range(1, len(times)) if times[number] < times[number - 1] - 1000]
        equal(len(back), 1, 'how often the time of the black box goes back an hour')
        before, after = '\n'.join(lines[:back[0]]), '\n'.join(lines[back[0]:])
        expect('608#0000000000A1' in before and '608#0000000000A2' in after, 'both sides of the jump are kept')
        with open(recovered['file']) as file:
            expect('502#' in file.read(), 'odometry in what the kill left')
        heard = sum(frame.id == '502' for frame in log.finish())
        expect(sum(' 502#' in line for line in lines) <= heard, 'no more odometry than there was')


@check('an operator with a black box on a full disk counts what is not kept, and guards the robot')
def _(context):
    with tempfile.TemporaryDirectory() as folder, Vcan('vcan1'), Robot(context, 'vcan1'):
        box = os.path.join(folder, 'box')
        os.mkdir(box)
        sh('mount', '-t', 'tmpfs', '-o', 'size=16k', 'tmpfs', box)
        try:
            with Operator(context, folder, 'vcan1', '--black-box', box) as operator:
                send_as_fast_as_possible('vcan1', 2000)
                eventually(lambda: 'No space left on device' in operator.stderr, 'a word that the disk is full')
                drive_fast('vcan1')
                operator.event('switched', to='halted', cause='too_fast')
                operator.event('switched', to='driving', cause='still')
                equal(operator.stop(), 130, 'exit code')
                expect(operator.count('frames that a kill would have lost') >= 1000, f'the count: {operator.stderr}')
                equal(operator.count('recording lost'), 1, f'recordings: {operator.stderr}')
        finally:
            sh('umount', box)


@check('the examples in C drive the robot on SocketCAN')
def _(context):
    with tempfile.TemporaryDirectory() as folder, Vcan('vcan1'), Robot(context, 'vcan1'):
        header, _ = amiroctl(context, 'generate', 'c', '-o', '-')
        with open(os.path.join(folder, 'amiro.h'), 'w') as file:
            file.write(header)
        for name, steps, period, topics in (('6_model', 20, '0132', ('103',)), ('7_loop', 12, '0132', ('103', '11F'))):
            program = os.path.join(folder, name)
            sh('gcc', '-std=c99', '-D_GNU_SOURCE', '-O1', '-I' + folder, '-I' + os.path.join(context.source, 'include'),
               os.path.join(context.source, 'examples', name + '.c'), '-lm', '-o', program)
            with Candump('vcan1') as log:
                done = subprocess.run([program, 'vcan1', str(steps)], text=True, capture_output=True, timeout=600)
                equal((done.returncode, done.stderr), (0, ''), name)
                matches(done.stdout, '0( frames)? lost')
                frames = log.finish()
            commands = [f'{frame.id}#{frame.data}' for frame in frames if not int(frame.id, 16) & 0x400]
            for topic in topics:
                expect(any(text.startswith(f'{topic}#{period}') for text in commands), f'{name} asks for {topic}: {commands}')
                expect(commands.index(f'{topic}#00') > 0, f'{name} stops {topic}')
            points = [frame.data for frame in frames if frame.id == '201']
            equal(len(points), steps + 1, f'set points of {name}')
            equal(points[-1], REST, f'the last set point of {name}')
            received = sum(frame.id in ('502', '503', *(f'5{0x1F + i:02X}' for i in range(8))) for frame in frames)
            expect(received > steps, f'{name}: {received} frames of samples')
