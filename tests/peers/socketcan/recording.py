"""amiroctl record and replay on CAN interfaces, beside candump and canplayer, at the same time and with each other's
files."""
import os
import re
import signal
import tempfile
import time

import can

from harness import Candump, Process, Vcan, as_nobody, check, equal, eventually, expect, sh
from tool import amiroctl, cansend, matches, send_as_fast_as_possible

LINE = re.compile(r'^\((\d+\.\d+)\) (\S+) (\S+#\S*)(?: ([RT]))?$')


class Recorder(Process):
    """amiroctl record, once it listens."""
    def __init__(self, context, path, *options, interface='vcan0', prefix=()):
        super().__init__(*prefix, context.amiroctl, '--bus', interface, 'record', '-o', path, *options)
        eventually(lambda: 'Ctrl-C ends' in self.stderr or self.process.poll() is not None, 'record listens')

    def finish(self):
        """After the frames that are still in its queue: CPU seconds that it took."""
        self.settle()
        self.send_signal(signal.SIGINT)
        _, status, usage = os.wait4(self.process.pid, 0)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        equal(self.process.returncode, 130, f'exit code of record ({self.stderr})')
        return usage.ru_utime + usage.ru_stime


def lines(path):
    with open(path) as file:
        found = [LINE.match(line.rstrip('\n')) for line in file]
    expect(None not in found, f'{path}: not a candump log')
    return found


def frames(path):
    return [line[3] for line in lines(path)]


class CandumpLog(Process):
    """candump -l, which chooses the name of its file itself."""
    def __init__(self, folder):
        self.folder = folder
        super().__init__('candump', '-l', '-r', '33554432', 'vcan0', listens_on='vcan0', cwd=folder)
        expect(self.process.poll() is None, f'candump ended: {self.stderr}')

    def finish(self):
        """After the frames that are still in its queue: CPU seconds that it took."""
        self.settle()
        self.process.send_signal(signal.SIGINT)
        _, _, usage = os.wait4(self.process.pid, 0)
        self.process.returncode = 0
        return usage.ru_utime + usage.ru_stime

    @property
    def path(self):
        name, = [name for name in os.listdir(self.folder) if name.startswith('candump-')]
        return os.path.join(self.folder, name)


class Folder(tempfile.TemporaryDirectory):
    def __enter__(self):
        super().__enter__()
        return lambda name: os.path.join(self.name, name)


@check('record loses nothing that candump keeps, and costs less')
def _(context):
    sent = 20000
    with Folder() as path:
        log = CandumpLog(path(''))
        recorder = Recorder(context, path('ours.log'))
        begin = time.monotonic()
        send_as_fast_as_possible('vcan0', sent)
        lasted = time.monotonic() - begin
        ours = recorder.finish()
        theirs = log.finish()
        wanted = [f'608#{i.to_bytes(6, "little").hex().upper()}' for i in range(sent)]
        equal(len(frames(log.path)), sent, 'frames that candump recorded')
        expect(frames(path('ours.log')) == wanted, 'record has all frames in order')
        times = [line[1] for line in lines(path('ours.log'))]
        equal(times, [line[1] for line in lines(log.path)], 'times')
        print(f'#   {sent / lasted:.0f} frames/s; CPU a frame: record {ours / sent * 1e6:.1f} us, '
              f'candump -l {theirs / sent * 1e6:.1f} us')


@check('record at 2000 frames a second costs less than candump')
def _(context):
    with Folder() as path:
        log = CandumpLog(path(''))
        recorder = Recorder(context, path('ours.log'))
        sh('cangen', 'vcan0', '-g', '0.5', '-n', '6000', '-I', 'i', '-L', '8')
        ours = recorder.finish()
        theirs = log.finish()
        equal(frames(path('ours.log')), frames(log.path), 'frames')
        print(f'#   CPU a frame: record {ours / 6000 * 1e6:.1f} us, '
              f'candump -l {theirs / 6000 * 1e6:.1f} us')


@check('record keeps CAN FD, remote, extended and error frames, and who sent them')
def _(context):
    with Vcan('vcan9', up=False) as vcan, Folder() as path:
        sh('ip', 'link', 'set', 'vcan9', 'mtu', '72')
        vcan.up()
        sent = ['123##1AABBCC', '18FF1234##0' + '11' * 64, '123#R', '1F334455#R4', '7FF#', '18FF1234#0102',
                '20000004#0010000000000000']
        with Candump('vcan9') as log, Recorder(context, path('a.log'), interface='vcan9') as recorder, \
             Recorder(context, path('filtered.log'), '--filter', '18FF0000:1FFF0000', interface='vcan9') as filtered:
            cansend(*sent, interface='vcan9')
            recorder.finish()
            filtered.finish()
            log.finish()
            theirs = re.findall(r'^\(\S+\) \S+ (\S+)', log.stdout, re.M)
        # candump 2020.11 writes FD flags as they come from the kernel, with CANFD_FDF; the notation has BRS and ESI.
        equal(frames(path('a.log')), sent, 'frames')
        equal(len(theirs), len(sent), f'frames that candump saw ({theirs})')
        for line in lines(path('a.log')):
            expect(line[4] in ('T', None), f'sent on this machine: {line[0]}')
        equal(frames(path('filtered.log')), [sent[1], sent[5], sent[6]], 'frames that pass the filter')


@check('record counts every frame that it had no room for')
def _(context):
    sent = 3000
    with Folder() as path:
        os.chmod(os.path.dirname(path('')), 0o777)
        with Recorder(context, path('a.log'), prefix=as_nobody()) as recorder:
            recorder.send_signal(signal.SIGSTOP)
            send_as_fast_as_possible('vcan0', sent)
            recorder.send_signal(signal.SIGCONT)
            recorder.finish()
            lost = re.search(r'(\d+) lost in the receive queue', recorder.stderr)
        expect(lost, f'nothing is said of lost frames: {recorder.stderr}')
        expect(int(lost[1]) > 1000, f'only {lost[1]} lost: the check did not fill the queue')
        equal(len(frames(path('a.log'))) + int(lost[1]), sent, 'recorded and lost')


@check('record goes on when an interface is down, and when it was unplugged')
def _(context):
    with Folder() as path:
        with Vcan('vcan9') as vcan, Recorder(context, path('a.log'), interface='vcan9') as recorder:
            cansend('608#01', interface='vcan9')
            vcan.down()
            eventually(lambda: 'vcan9 went down' in recorder.stderr, 'down is reported')
            vcan.up()
            eventually(lambda: 'vcan9 is up again' in recorder.stderr, 'up is reported')
            cansend('608#02', interface='vcan9')
            recorder.settle()
            sh('ip', 'link', 'del', 'vcan9')
            eventually(lambda: 'is gone' in recorder.stderr, 'gone is reported')
            with Vcan('vcan9'):
                eventually(lambda: 'vcan9 is back' in recorder.stderr, 'back is reported')
                cansend('608#03', interface='vcan9')
                recorder.finish()
        equal(frames(path('a.log')), ['608#01', '608#02', '608#03'], 'frames')


@check('record takes several interfaces in the order of time')
def _(context):
    with Vcan('vcan8'), Vcan('vcan9'), Folder() as path:
        with Recorder(context, path('a.log'), interface='vcan8,vcan9') as recorder:
            with can.Bus(interface='socketcan', channel='vcan8') as first, \
                 can.Bus(interface='socketcan', channel='vcan9') as second:
                for i in range(2000):
                    bus = first if i * 7919 % 3 else second
                    bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=i.to_bytes(4, 'big')))
            recorder.finish()
        equal(frames(path('a.log')), [f'123#{i:08X}' for i in range(2000)], 'frames')


@check('canplayer, candump and python-can take what record has written')
def _(context):
    sent = ['608#00D200000000', '18FF1234#AABB', '123#R', '7FF#']
    with Vcan('vcan9'), Folder() as path:
        with Recorder(context, path('a.log'), interface='vcan9') as recorder:
            cansend(*sent, interface='vcan9')
            recorder.finish()
        with Candump('vcan9') as log:
            sh('canplayer', '-I', path('a.log'))
            played = log.finish()
            equal(re.findall(r'^\(\S+\) \S+ (\S+)', log.stdout, re.M), sent, 'what canplayer has sent')
        expect(played, 'frames')
        with can.LogReader(path('a.log')) as reader:
            equal([(message.arbitration_id, bytes(message.data), message.is_remote_frame) for message in reader],
                  [(0x608, bytes.fromhex('00D200000000'), False), (0x18FF1234, b'\xAA\xBB', False), (0x123, b'', True),
                   (0x7FF, b'', False)], 'what python-can has read')


@check('replay of what candump has recorded comes again, frame by frame and in time')
def _(context):
    with Vcan('vcan9', up=False) as vcan, Folder() as path:
        sh('ip', 'link', 'set', 'vcan9', 'mtu', '72')
        vcan.up()
        with open(path('a.log'), 'w') as file:
            for i in range(200):  # every 20 ms, for which a guest needs a twentieth of a processor
                file.write(f'({100 + i * 0.02:.6f}) can7 {"123##1" if i % 50 == 0 else "123#"}{i:08X}\n')
        with Candump('vcan9') as log:
            _, stderr = amiroctl(context, '--bus', 'vcan9', 'replay', path('a.log'))
            log.finish()
            seen = re.findall(r'^\((\S+)\) \S+ 123#(?:#.)?(\S+)', log.stdout, re.M)
        matches(stderr, r'sent 200 frames in [0-9.]+s')
        equal([int(data, 16) for _, data in seen], list(range(200)), 'frames')
        # By the clock that tells when this machine was held up: a frame that was due meanwhile comes behind that.
        monotonic = time.monotonic() - time.time()
        came = [float(stamp) + monotonic for stamp, _ in seen]
        begin = min(at - i * 0.02 for i, at in enumerate(came))
        late = [at - begin - i * 0.02 for i, at in enumerate(came)]
        held_up = [context.spare.held_up_between(begin + i * 0.02 - 0.01, at) for i, at in enumerate(came)]
        own = [each - held for each, held in zip(late, held_up)]
        expect(max(own) < 0.1, f'{max(late):.4f} s off, {max(own):.4f} s more than the machine was held up')
        said = float(re.search(r'in ([0-9.]+)s', stderr)[1])
        expect(3.97 <= said < 4.08 + max(held_up), stderr)
        print(f'#   median {sorted(late)[100] * 1e6:.0f} us off, worst {max(late) * 1e6:.0f} us')


@check('replay waits while the queue of an interface is full, and sends every frame once')
def _(context):
    with Folder() as path:
        sh('ip', 'link', 'set', 'vcan0', 'txqueuelen', '10')
        with open(path('a.log'), 'w') as file:
            file.writelines(f'(1.000000) can0 123#{i:08X}\n' for i in range(5000))
        with Candump('vcan0') as log:
            amiroctl(context, '--bus', 'vcan0', 'replay', path('a.log'), '--speed', 'max')
            equal([int(frame.data, 16) for frame in log.finish()], list(range(5000)), 'frames')
