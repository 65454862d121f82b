"""amiroctl and the simulated robot on real CAN interfaces. What must come is typed from the thesis, and reckoned
here, not by the code under test. Raw frames are the judge: candump and python-can, not the tool's own output."""
# Sleeps: a sensor publishes, a board does not answer, or an interface is down for so long.
import json
import os
import re
import signal
import socket
import subprocess
import time

import can

from harness import (Adapter, Candump, Process, Vcan, as_nobody, check, equal, eventually, expect,
                     forbid_can_sockets, sh)

# The thesis's standalone demo [Thesis 6.3, in the order of its timing diagram], as it must come on the bus:
# second, frame. A drive is one frame here; its repeats are looked at by themselves. Before it the board is asked what it does by itself,
# and 100 ms behind all of it, whether the lights' board is there, of which nothing was heard.
STANDALONE = [
    (1, '209#01F40100'), (5, '21F#01E80300'), (10, '21E#02'), (15, '208#01881300'), (16, '21F#00'),
    (17, '205#01200300'), (18, '209#00'), (21, '203#01840300'),
    (22.9, '20D#02'), (23, '201#50C3000000000000'), (25, '23C#FFFFFF'),
    (27, '201#0000000000000000'), (30, '203#00'), (31, '208#00'), (32, '21E#02'), (33, '204#01D00700'),
    (35, '205#00'), (38, '204#00'), (40, '23D#FFFFFF'), (40, '23F#FFFFFF'), (40, '241#FFFFFF'), (40, '243#FFFFFF'),
    (40.1, '357#02')]
# What the sensors must answer: frames of a sample (identifier, length), first second, last, period. One sample at
# once, then one a period until the stop; one that falls on the stop itself may come or not.
ANSWERS = {
    'accelerometer': ([('609', 6)], 1, 18, 0.5),
    'ring': ([(f'{0x61F + i:03X}', 2) for i in range(8)], 5, 16, 1.0),
    'gyroscope': ([('608', 6)], 15, 31, 5.0),
    'magnetometer': ([('605', 4), ('606', 4), ('607', 4)], 17, 35, 0.8),
    'odometry': ([('602', 8), ('603', 8)], 21, 30, 0.9),
    'floor': ([('604', 8)], 33, 38, 2.0)}
SO_RCVBUFFORCE = 33  # [asm-generic/socket.h]; the module socket has no name for it
TOLERANCE = 0.1  # seconds: what the guest, one CPU shared by four programs, may be late


def little(data, begin, end, signed=True):
    return int.from_bytes(bytes.fromhex(data)[begin:end], 'little', signed=signed)


class Robot(Process):
    """The simulated boards on a CAN interface."""
    def __init__(self, context, interface='vcan0', *options):
        super().__init__(context.amiroctl, 'sim', '--bus', interface, *options, listens_on=interface)
        expect(self.process.poll() is None, f'the simulated robot ended: {self.stderr}')

    def finish(self):
        expect(self.process.poll() is None, f'the simulated robot ended early: {self.stderr}')
        expect(self.stop() in (0, 130), f'exit code of sim: {self.process.returncode}: {self.stderr}')


def amiroctl(context, *arguments, code=0, prefix=(), **options):
    """Runs the tool to its end; returns stdout, stderr."""
    command = [*prefix, context.amiroctl, *arguments]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          timeout=300, **options)
    equal(done.returncode, code, f'exit code of {" ".join(command)} (stderr: {done.stderr.strip()})')
    return done.stdout, done.stderr


def matches(text, *patterns):
    for pattern in patterns:
        expect(re.search(pattern, text, re.S | re.I), f'/{pattern}/ is not in: {text.strip()}')


def cansend(*frames, interface='vcan0'):
    for frame in frames:
        sh('cansend', interface, frame)


def send_as_fast_as_possible(interface, count):
    """Numbered frames, from this process."""
    with can.Bus(interface='socketcan', channel=interface) as bus:
        for i in range(count):
            bus.send(can.Message(arbitration_id=0x608, is_extended_id=False, data=i.to_bytes(6, 'little')))


# --- the standalone script -------------------------------------------------------------------------------

def compare_commands(frames, held_up):
    """Each command exactly, in order and in time; what `held_up(begin, end)` says of a time that this machine let nothing run in is not
    the tool's. Returns the log's time of second 0, and when each command came."""
    commands, repeats = [], []
    motors = None
    for frame in frames:
        if int(frame.id, 16) & 0x400:
            continue
        text = f'{frame.id}#{frame.data}'
        if frame.id == '201':
            if text == motors:
                repeats.append(frame.time)
                continue
            motors = text
        commands.append((frame.time, text))
    equal([text for _, text in commands], [text for _, text in STANDALONE], 'commands')
    zero = min(when - second for (when, _), (second, _) in zip(commands, STANDALONE))  # none goes before its time
    for (when, text), (second, _) in zip(commands, STANDALONE):
        late = when - zero - second - held_up(zero + second, when)
        expect(late < TOLERANCE, f'{text}: at {when - zero:.3f} s instead of {second} s, {late:.3f} s of it by itself')
    # The drive is repeated every 100 ms from 23 s to 27 s, and the stop is not; a turn that is held up is left out.
    held = held_up(zero + 22.9, zero + 27.1)
    expect(38 - held / 0.1 <= len(repeats) <= 40, f'the set point of the motors was repeated {len(repeats)} times in 4 s')
    turns = [zero + 23] + repeats + [zero + 27]
    gaps = [b - a - held_up(a, b) for a, b in zip(turns, turns[1:])]
    expect(max(gaps) < 0.1 + TOLERANCE, f'{max(gaps):.3f} s without a set point: the watchdog stops the motors at 0.5')
    return zero, dict(zip([second for second, _ in STANDALONE], [when for when, _ in commands]))


def compare_answers(frames, came, held_up):
    """Each sensor's samples: how many, when, whole and back to back. A board counts its periods from the request on, as it came."""
    known = {'61E', '60D', '757', '758'}
    for name, (parts, first, last, period) in ANSWERS.items():
        first, last = came[first], came[last]
        ids = [number for number, _ in parts]
        known.update(ids)
        mine = [frame for frame in frames if frame.id in ids]
        equal([frame.id for frame in mine], ids * (len(mine) // len(ids)), f'{name}: order of the frames of a sample')
        for number, length in parts:
            wrong = [frame for frame in mine if frame.id == number and len(frame.data) != 2 * length]
            expect(not wrong, f'{name}: wrong length: {wrong}')
        samples = [mine[i:i + len(ids)] for i in range(0, len(mine), len(ids))]
        begun_late = held_up(first, samples[0][0].time) if samples else 0.0
        due = [first + k * period for k in range(1000) if first + k * period < last + 1e-9]
        certain = [when for when in due if when < last - TOLERANCE - begun_late - held_up(when, last)]
        expect(len(certain) <= len(samples) <= len(due),
               f'{name}: {len(samples)} samples instead of {len(certain)} to {len(due)}')
        for sample, when in zip(samples, due):
            late = sample[0].time - when
            expect(-TOLERANCE < late < TOLERANCE + begun_late + held_up(when, sample[0].time),
                   f'{name}: the sample of {when - first:.1f} s after the request came {late * 1000:.0f} ms late')
            spread = sample[-1].time - sample[0].time - held_up(sample[0].time, sample[-1].time)
            expect(spread < 0.05, f'{name}: {spread * 1000:.0f} ms between the frames of a sample')
        if len(samples) > 2:  # no drift: the mean is far better than any single one
            mean = (samples[-1][0].time - samples[0][0].time) / (len(samples) - 1)
            held = begun_late + held_up(due[len(samples) - 1], samples[-1][0].time)
            expect(abs(mean - period) < (2 * TOLERANCE + held) / (len(samples) - 1), f'{name}: a period of {mean:.4f} s')
    power = [frame.time for frame in frames if frame.id == '61E']
    equal([round(at - came[when]) for at, when in zip(power, (10, 32))], [0] * len(power), 'power: when')
    equal(len(power), 2, 'power: once, twice')
    equal(len([frame for frame in frames if frame.id == '60D']), 1, 'what the board does by itself, before the drive')
    equal([frame.id for frame in frames if frame.id in ('757', '758')], ['757', '758'], "the lights' board, behind it")
    unknown = {frame.id for frame in frames if int(frame.id, 16) & 0x400} - known
    expect(not unknown, f'frames without a request: {unknown}')


def compare_physics(frames, zero, came):
    """The robot stands, drives at 5 cm/s from 23 s to 27 s, stands."""
    for frame in frames:
        second = frame.time - zero
        if frame.id == '609':
            up = little(frame.data, 4, 6) / 1024
            expect(0.9 < up < 1.1, f'accelerometer: {up:.3f} g upwards at {second:.1f} s')
        if frame.id == '602':
            speed = little(frame.data, 0, 4) * 1e-6
            if came[23] + 0.8 < frame.time < came[27]:
                expect(0.04 < speed < 0.06, f'velocity {speed:.3f} m/s at {second:.1f} s')
            elif frame.time < came[23] or frame.time > came[27] + 1.2:
                expect(abs(speed) < 0.01, f'velocity {speed:.3f} m/s at {second:.1f} s')
    path = [(little(frame.data, 0, 3), little(frame.data, 3, 6)) for frame in frames if frame.id == '603']
    way = ((path[-1][0] - path[0][0]) ** 2 + (path[-1][1] - path[0][1]) ** 2) ** 0.5 * 256e-6
    expect(0.15 < way < 0.24, f'way driven: {way:.3f} m; 4 s at 5 cm/s are 0.2 m')


@check('the standalone script causes exactly its commands and answers')
def _(context):
    script = os.path.join(context.source, 'examples', 'standalone.script')
    recorder = can.Bus(interface='socketcan', channel='vcan0')  # python-can sees the same
    recorder.socket.setsockopt(1, 33, 1 << 24)                  # SOL_SOCKET, SO_RCVBUFFORCE
    with Robot(context) as robot, Candump('vcan0') as log:
        _, stderr = amiroctl(context, '--bus', 'vcan0', 'run', script)
        frames = log.finish()
        robot.finish()
    if context.output:
        with open(os.path.join(context.output, 'standalone.log'), 'w') as file:
            file.write(log.stdout)
    matches(stderr, 'vcan0')
    seen = []
    while (message := recorder.recv(0)) is not None:
        seen.append((f'{message.arbitration_id:03X}', message.data.hex().upper()))
    recorder.shutdown()
    equal(seen, [(frame.id, frame.data) for frame in frames], 'what python-can has read')
    monotonic = time.monotonic() - time.time()  # by its clock the machine was held up

    def held_up(begin, end):
        return context.spare.held_up_between(begin + monotonic, end + monotonic)

    zero, came = compare_commands(frames, held_up)
    compare_answers(frames, came, held_up)
    compare_physics(frames, zero, came)


# --- other people's frames -------------------------------------------------------------------------------

@check('frames written by hand from the thesis drive the robot')
def _(context):
    with Robot(context) as robot:
        amiroctl(context, '--bus', 'vcan0', 'once', 'floor', '--wait', '10s')  # a board that has just started may have no sample
        with Candump('vcan0') as log:
            cansend('204#02')                        # floor, once
            eventually(lambda: any(frame.id == '604' for frame in log.frames()), 'floor, once: an answer')
            def seen(number, count):
                eventually(lambda: sum(frame.id == number for frame in log.frames()) >= count, f'{count} frames {number}')
            cansend('208#01')                        # gyroscope at the default period, 50 ms
            seen('608', 20)
            cansend('208#00')
            time.sleep(0.3)
            cansend('205#01840302')                  # magnetometer every 900 us: more than the guest can do
            seen('605', 101)
            cansend('205#00')

            def quiet():
                before = len(log.frames())
                time.sleep(0.3)
                return len(log.frames()) == before
            eventually(quiet, 'the magnetometer stops')  # a slow guest has a queue of its samples still
            cansend('009#01640000')                  # accelerometer, urgent, 100 ms: answers are urgent too
            seen('409', 5)
            cansend('209#02')                        # once, medium: one more, and the end
            seen('609', 1)
            for refused in ('208#03', '208#', '208#0132', '208#01320003', '208#01000000', '208#R'):
                cansend(refused)
            cansend('23C#FF8000', '201#A086010000000000')
            time.sleep(0.2)
            robot.finish()
            frames = log.finish()
    answers = [frame for frame in frames if int(frame.id, 16) & 0x400]
    times = {number: [frame.time for frame in answers if frame.id == number] for number in {f.id for f in answers}}
    equal(len(times.pop('604', [])), 1, 'floor, once')
    asked = {f'{frame.id}#{frame.data}': frame.time for frame in frames}
    gyro = times.pop('608', [])
    due = (asked['208#00'] - asked['208#01']) / 0.05 + 1
    expect(abs(len(gyro) - due) < 2.5, f'gyroscope: {len(gyro)} samples instead of {due:.1f}')
    expect(gyro[-1] < asked['205#01840302'], 'gyroscope: answered to what it must refuse, or did not stop')
    mag = [times.pop(number, []) for number in ('605', '606', '607')]
    expect(len(mag[0]) > 100, f'magnetometer: {len(mag[0])} samples')
    expect(max(map(len, mag)) - min(map(len, mag)) == 0, f'magnetometer: {[len(axis) for axis in mag]} frames of the axes')
    expect(mag[2][-1] < asked['009#01640000'], 'magnetometer: did not stop')
    due = (asked['209#02'] - asked['009#01640000']) / 0.1 + 1
    urgent = times.pop('409', [])
    expect(abs(len(urgent) - due) < 1.5, f'accelerometer, urgent: {len(urgent)} samples instead of {due:.1f}')
    equal(len(times.pop('609', [])), 1, 'accelerometer, once')
    # 0x1B.. are the boards' status identifiers: answers to refused requests may come there.
    times = {number: stamps for number, stamps in times.items() if not 0x1B <= int(number, 16) & 0xFF <= 0x1D}
    equal(times, {}, 'frames without a request')


@check('what the thesis printed is decoded to physical values')
def _(context):
    # Frame, field, value, tolerance. Raw values: the thesis's log of its receiver [Thesis 7.2]; the physical ones
    # follow from the parts' data sheets. The other fields are zero.
    vectors = [
        ('608#FCFF00000000', 'gyroscope', 'x', '-0.07'),              # 65532
        ('609#000000000004', 'accelerometer', 'z', '1'),              # 1024
        ('609#FEFF00000000', 'accelerometer', 'x', '-0.001953125'),   # 65534
        ('605#00AAF1FF', 'magnetometer', 'field', '-0.93952'),        # -939520
        ('61E#0000FFFF5EFC', 'power_status', 'power', '-930'),        # 64606
        ('603#0000000000009106', 'odometry', 'orientation', '0.430336')]  # 1681
    with Process(context.amiroctl, '--bus', 'vcan0', 'listen', '--json', '-n', str(len(vectors)), '--timeout', '20s',
                 listens_on='vcan0') as listen:
        cansend(*[frame for frame, _, _, _ in vectors])
        equal(listen.wait(), 0, f'exit code of listen ({listen.stderr})')
        lines = listen.stdout.splitlines()
    equal(len(lines), len(vectors), 'lines')
    for line, (frame, topic, field, value) in zip(lines, vectors):
        event = json.loads(line, parse_float=str, parse_int=str)
        equal((event['topic'], event['fields'][field], event['data'], event['bus'], event['priority']),
              (topic, value, frame.split('#')[1], 'vcan0', 'medium'), line)
        expect(abs(int(event['time_ns']) * 1e-9 - time.time()) < 60, f'time_ns: {event["time_ns"]}')


@check('the tool, candump and python-can see the same frames')
def _(context):
    with Robot(context) as robot, Candump('vcan0') as log, \
            can.Bus(interface='socketcan', channel='vcan0') as recorder, \
            Process(context.amiroctl, '--bus', 'vcan0', 'listen', '--raw', '--commands', listens_on='vcan0') as listen:
        # Room for all of it: it is read at the end.
        recorder.socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 8 << 20)
        for words in ('publish ring 100ms', 'publish odom 50ms', 'led all red', 'drive 5cm/s --for 500ms', 'stop'):
            amiroctl(context, '--bus', 'vcan0', *words.split())
        frames = log.finish()
        expect(listen.stop() in (0, 130), f'exit code of listen: {listen.stderr}')
        robot.finish()
        lines = listen.stdout.splitlines()
        seen = []
        while (message := recorder.recv(0)) is not None:
            seen.append((f'{message.arbitration_id:03X}', message.data.hex().upper()))
    wanted = [(frame.id, frame.data) for frame in frames]
    expect(len(wanted) > 50, f'only {len(wanted)} frames')
    equal(seen, wanted, 'python-can')
    equal([tuple(line.split()[2].split('#')) for line in lines], wanted, 'listen --raw')
    stamps = [float(line.split()[0].strip('()')) for line in lines]
    expect(all(abs(a - frame.time) < 1e-5 for a, frame in zip(stamps, frames)), 'times of listen --raw and candump differ')


# --- what can go wrong -----------------------------------------------------------------------------------

@check('amiroctl names what is wrong with an interface, and the remedy')
def _(context):
    with Vcan('vcan8', up=False):
        for name, *patterns in (('can7', "no interface 'can7'", 'vcan0'), ('lo', "'lo' is not a CAN interface"),
                                ('vcan8', "'vcan8' is down", 'sudo ip link set vcan8 up'),
                                ('averyverylongname', '17 characters', 'at most 15'), ('vcan0:1', "no interface")):
            for verb in (['send', '205#00'], ['listen', '--timeout', '1s'], ['sim']):
                _, stderr = amiroctl(context, '--bus', name, *verb, code=1)
                matches(stderr, *patterns)


@check('amiroctl takes the only interface that is up, and refuses to guess')
def _(context):
    with Candump('vcan0') as log:
        _, stderr = amiroctl(context, 'send', '205#00')
        matches(stderr, 'vcan0')
        equal([f'{frame.id}#{frame.data}' for frame in log.finish()], ['205#00'], 'frames')
    with Vcan('vcan1'):
        _, stderr = amiroctl(context, 'send', '205#00', code=2)
        matches(stderr, 'vcan0', 'vcan1', '--bus')
    sh('ip', 'link', 'set', 'vcan0', 'down')
    try:
        _, stderr = amiroctl(context, 'send', '205#00', code=1)
        matches(stderr, 'ip link set')
    finally:
        sh('ip', 'link', 'set', 'vcan0', 'up')


@check('amiroctl needs no privileges, and says when a sandbox forbids CAN')
def _(context):
    with Candump('vcan0') as log:
        amiroctl(context, '--bus', 'vcan0', 'publish', 'gyro', '500ms', '--no-confirm', prefix=as_nobody())
        equal([f'{frame.id}#{frame.data}' for frame in log.finish()], ['208#01F40100'], 'frames')
    _, stderr = amiroctl(context, '--bus', 'vcan0', 'send', '205#00', code=1, preexec_fn=forbid_can_sockets)
    matches(stderr, 'not allowed to open a CAN socket', 'sandbox')


@check('listen tells that the interface went down and came back, and goes on')
def _(context):
    with Vcan('vcan1') as interface, \
            Process(context.amiroctl, '--bus', 'vcan1', 'listen', '--raw', listens_on='vcan1') as listen:
        cansend('608#000000000001', interface='vcan1')
        eventually(lambda: '#000000000001' in listen.stdout, 'the first frame')
        interface.down()
        eventually(lambda: re.search(r'vcan1.*down', listen.stderr), 'a word that vcan1 is down')
        interface.up()
        eventually(lambda: re.search(r'vcan1.*(up|back)', listen.stderr), 'a word that vcan1 is back')
        cansend('608#000000000002', interface='vcan1')
        eventually(lambda: '#000000000002' in listen.stdout, 'the frame after')
        expect(listen.stop() in (0, 130), f'exit code: {listen.stderr}')
        equal(len(re.findall(r'vcan1.*down', listen.stderr)), 1, f'how often it was reported: {listen.stderr}')


@check('a drive goes on when the interface comes back, and fails in words when it does not')
def _(context):
    with Vcan('vcan1') as interface, Candump('vcan1') as log, \
            Process(context.amiroctl, '--bus', 'vcan1', 'drive', '5cm/s') as drive:
        eventually(lambda: len(log.frames()) > 3, 'set points')
        # As long as the motors' watchdog waits, 500 ms, the drive waits, too. How long the interface was away is this
        # machine's affair.
        away = time.monotonic()
        interface.down()
        time.sleep(0.1)
        interface.up()
        away = time.monotonic() - away
        before = len(log.frames())
        eventually(lambda: len(log.frames()) > before + 3 or drive.process.poll() is not None, 'more set points')
        if away < 0.3:
            expect(drive.process.poll() is None, f'drive ended: {drive.stderr}')
        interface.down()
        equal(drive.wait(), 1, 'exit code with the interface down for good')
        matches(drive.stderr, 'vcan1.*down')


@check('an interface that is deleted ends every verb in words')
def _(context):
    for verb in (['listen'], ['drive', '5cm/s'], ['sim']):
        with Vcan('vcan1') as interface, Candump('vcan1') as log:
            listens = 'vcan1' if verb[0] != 'drive' else None
            with Process(context.amiroctl, '--bus', 'vcan1', *verb, listens_on=listens) as process:
                if verb[0] == 'drive':
                    eventually(lambda: log.frames(), 'a set point')
                sh('ip', 'link', 'del', interface.name)
                equal(process.wait(), 1, f'exit code of {verb[0]}')
                matches(process.stderr, "'vcan1' is gone")


@check('a full queue is reported, and what was taken is sent')
def _(context):
    frames = 2000
    script = ''.join(f'0s send 205#{i:016X}\n' for i in range(frames))
    with Adapter() as adapter:
        with Process('sh', '-c', 'printf "%s" "$1" | "$0" --bus "$2" run -', context.amiroctl, script,
                     adapter.name) as run:
            equal(run.wait(), 1, f'exit code ({run.stderr[-300:]})')
            matches(run.stderr, f'queue of {adapter.name}', 'was not sent')
            refused = int(re.search(r'205#([0-9A-F]{16}) was not sent', run.stderr)[1], 16)
        taken = re.findall(r't2058([0-9A-F]{16})\r', adapter.sent())
        equal([int(number, 16) for number in taken], list(range(refused)), 'what the adapter got')


@check('a controller that is bus-off: no command succeeds, and each says so')
def _(context):
    def go_off(adapter):
        adapter.report('sb256000')
        eventually(lambda: 'BUS-OFF' in sh('ip', '-details', 'link', 'show', adapter.name), 'bus-off')

    with Adapter() as adapter:
        go_off(adapter)
        for verb in (['stop'], ['publish', 'gyro', '100ms', '--force'], ['drive', '5cm/s', '--for', '2s'],
                     ['set', 'motors', 'x=0m/s'], ['send', '123#00'], ['doctor']):
            with Process(context.amiroctl, '--bus', adapter.name, *verb) as process:
                equal(process.wait(), 1, f'exit code of {verb[0]}: {process.stderr}')
                matches(process.stderr, f"'{adapter.name}' is bus-off", 'nothing was sent')
        equal(re.findall(r't\d.*', adapter.sent()), [], 'frames of a controller that is bus-off')
    with Adapter() as adapter, Process(context.amiroctl, '--bus', adapter.name, 'drive', '5cm/s') as drive:
        eventually(lambda: 't2018' in adapter.sent(0.05), 'a set point')
        go_off(adapter)
        equal(drive.wait(), 1, f'exit code of a drive that loses its bus: {drive.stderr}')
        matches(drive.stderr, 'is bus-off', 'THE ROBOT MAY STILL MOVE')


@check('error frames are put into words and counted')
def _(context):
    for strict, code in (([], 0), (['--strict'], 1)):
        with Process(context.amiroctl, '--bus', 'vcan0', 'listen', '--pretty', '-n', '2', '--timeout', '20s', *strict,
                     listens_on='vcan0') as listen:
            cansend('20000040#0000000000000000', '20000004#0010000000000000')
            equal(listen.wait(), code, f'exit code with {strict}')
            matches(listen.stdout + listen.stderr, 'bus-off', 'error passive', '2 error frames')


@check('error frames of an adapter are put into words')
def _(context):
    with Adapter() as adapter:
        with Process(context.amiroctl, '--bus', adapter.name, 'listen', '--json', '-n', '3', '--timeout', '60s',
                     listens_on=adapter.name) as listen:
            for line in ('sp200100', 'sb256000', 'e1a'):
                adapter.report(line)
            equal(listen.wait(), 0, f'exit code ({listen.stderr})')
            errors = [json.loads(line)['error'] for line in listen.stdout.splitlines()]
    for error, pattern in zip(errors, ('error passive', 'bus-off', 'no acknowledgement')):
        matches(error, pattern)


@check('frames that listen had no room for are counted, every one')
def _(context):
    sent = 3000
    with Process(*as_nobody(context.amiroctl), '--bus', 'vcan0', 'listen', '--raw', listens_on='vcan0') as listen:
        listen.send_signal(signal.SIGSTOP)
        send_as_fast_as_possible('vcan0', sent)
        listen.send_signal(signal.SIGCONT)
        cansend('608#FFFFFFFFFFFF')
        eventually(lambda: '#FFFFFFFFFFFF' in listen.stdout, 'the last frame')
        expect(listen.stop() in (0, 130), f'exit code: {listen.stderr}')
        lost = re.search(r'(\d+) lost', listen.stderr)
    expect(lost, f'nothing is said of lost frames: {listen.stderr}')
    expect(int(lost[1]) > 1000, f'only {lost[1]} lost: the check did not fill the queue')
    equal(len(listen.stdout.splitlines()) + int(lost[1]), sent + 1, 'shown and lost')


FD_SPEC = """VERSION ""
BU_: Radar
BO_ 291 Objects: 64 Radar
 SG_ count : 0|8@1+ (1,0) [0|255] "" Radar
 SG_ last : 504|8@1+ (1,0) [0|255] "" Radar
BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG","r4","r5","r6","r7","r8","r9","r10","r11","r12","r13","StandardCAN_FD","ExtendedCAN_FD";
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;
BA_DEF_DEF_ "VFrameFormat" "StandardCAN";
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "VFrameFormat" BO_ 291 14;
BA_ "GenMsgCycleTime" BO_ 291 20;
"""


@check('CAN FD: what send and set send, candump and python-can read; what cansend sends, listen shows')
def _(context):
    sent = ['123##1DEAD', '1F334455##0' + '5A' * 48, '123#DEAD', '7FF##3']
    message = '07' + '00' * 62 + '09'
    with Vcan('vcan9', up=False) as vcan:
        sh('ip', 'link', 'set', 'vcan9', 'mtu', '72')
        vcan.up()
        with open('/tmp/fd.dbc', 'w') as file:
            file.write(FD_SPEC)
        with Candump('vcan9') as log, can.Bus(interface='socketcan', channel='vcan9', fd=True) as bus:
            for frame in sent:
                amiroctl(context, '--bus', 'vcan9', 'send', frame)
            amiroctl(context, '--bus', 'vcan9', '--spec', '/tmp/fd.dbc', 'set', 'Objects', 'count=7', 'last=9')
            theirs = [bus.recv(60) for _ in range(len(sent) + 1)]
            log.finish()
            shown = re.findall(r'^\(\S+\) \S+ (\S+)', log.stdout, re.M)
        # candump 2020.11 writes the flags as the kernel has them, with FDF (4).
        equal([re.sub('##(.)', lambda flags: f'##{int(flags[1], 16) & 3}', frame) for frame in shown],
              [*sent, f'123##1{message}'], 'candump')
        equal([(m.arbitration_id, m.is_fd, m.bitrate_switch, m.error_state_indicator, bytes(m.data)) for m in theirs],
              [(0x123, True, True, False, b'\xDE\xAD'), (0x1F334455, True, False, False, b'\x5A' * 48),
               (0x123, False, False, False, b'\xDE\xAD'), (0x7FF, True, True, True, b''),
               (0x123, True, True, False, bytes.fromhex(message))], 'python-can')
        with Process(context.amiroctl, '--bus', 'vcan9', 'listen', '--json', '-n', '2', '--timeout', '20s',
                     listens_on='vcan9') as listen:
            cansend('123##1AABB', '124#CC', interface='vcan9')
            equal(listen.wait(), 0, f'exit code of listen ({listen.stderr})')
            lines = [json.loads(line) for line in listen.stdout.splitlines()]
        equal([(line.get('fd'), line['data']) for line in lines],
              [({'brs': True, 'esi': False}, 'AABB'), (None, 'CC')], 'listen')
        with Process(context.amiroctl, '--bus', 'vcan9', '--spec', '/tmp/fd.dbc', 'listen', 'Objects', '--json', '-n', '1',
                     '--timeout', '20s', listens_on='vcan9') as listen:
            cansend(f'123##1{message}', interface='vcan9')
            equal(listen.wait(), 0, f'exit code of listen ({listen.stderr})')
            equal(json.loads(listen.stdout)['fields'], {'count': 7, 'last': 9}, 'fields')


@check('CAN FD: an interface without it is named, with what to type')
def _(context):
    with Vcan('vcan9', up=False) as vcan:
        sh('ip', 'link', 'set', 'vcan9', 'mtu', '16')
        vcan.up()
        with Candump('vcan9') as log:
            _, stderr = amiroctl(context, '--bus', 'vcan9', 'send', '123##1DEAD', code=1)
            matches(stderr, r"123##1DEAD is a CAN FD frame", r"interface 'vcan9' carries no CAN FD frames", r'MTU is 16',
                    r'ip link set vcan9 mtu 72')
            amiroctl(context, '--bus', 'vcan9', 'send', '123#DEAD')
            log.finish()
            equal(re.findall(r'^\(\S+\) \S+ (\S+)', log.stdout, re.M), ['123#DEAD'], 'candump')
