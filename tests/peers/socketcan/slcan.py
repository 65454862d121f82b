"""amiroctl on a serial line against the kernel's slcan driver: two adapters of the library, joined (slcan_relay), with
the driver and can-utils at one, the tool at the other. And both read the same reports of errors."""
import os
import re
import subprocess
import time
import tty

from harness import Adapter, Candump, Process, check, equal, eventually, expect, sh


class Relay:
    """`name`: the kernel's interface, up; `bus`: what --bus takes at the other end."""
    def __init__(self, context):
        self.process = subprocess.Popen([context.relay], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.name, path = self.process.stdout.readline().split()
        self.bus = f'slcan:{path}'
        sh('ip', 'link', 'set', self.name, 'up', 'type', 'can', 'bitrate', '500000')
        # One frame waits in the driver, the others in the interface's queue of 10: a burst needs more.
        sh('ip', 'link', 'set', self.name, 'txqueuelen', '1000')

    def finish(self):
        """Frames that the kernel sent, and the tool; lines that were none: none."""
        sh('ip', 'link', 'set', self.name, 'down')
        out, _ = self.process.communicate(timeout=300)
        counts = re.fullmatch(r'kernel sent (\d+), faults (\d+); other sent (\d+), faults (\d+)\n', out)
        expect(counts, f'what the relay said: {out!r}')
        equal((counts[2], counts[4]), ('0', '0'), 'lines that the adapters did not understand')
        return int(counts[1]), int(counts[3])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


def tool(context, relay, *arguments, code=0):
    done = subprocess.run([context.amiroctl, '--bus', relay.bus, *arguments], stdin=subprocess.DEVNULL, text=True,
                          capture_output=True, timeout=300)
    equal(done.returncode, code, f'exit code of {arguments}: {done.stderr.strip()}')
    return done.stdout


def listening(context, bus, *arguments):
    """`listen --raw` of every frame, subscribed."""
    process = Process(context.amiroctl, '--bus', bus, 'listen', '--raw', '--commands', '--timeout', '60s', *arguments)
    eventually(lambda: 'bus:' in process.stderr or process.process.poll() is not None, 'listen opens its bus')
    expect(process.process.poll() is None, f'listen ended: {process.stderr}')
    return process


def raw_frames(process):
    return re.findall(r'^\([0-9.]+\) \S+ (\S+)', process.stdout, re.M)


@check('slcan: what can-utils send on the kernel\'s interface, the tool hears on the serial line, to the frame')
def _(context):
    count = 3000
    with Relay(context) as relay:
        with Candump(relay.name) as judge, listening(context, relay.bus) as listener:
            # Base and extended, data and remote frames of every length.
            for options in (('-I', 'r', '-L', 'r', '-D', 'r'), ('-e', '-I', 'r', '-L', 'r', '-D', 'r'),
                            ('-R', '-I', 'r', '-L', 'r')):
                sh('cangen', relay.name, '-n', str(count // 3), '-g', '1', '-p', '10', *options)
            wanted = [f'{frame.id}#{frame.data}' for frame in judge.finish()]
            equal(len(wanted), count, 'frames on the interface')
            eventually(lambda: len(raw_frames(listener)) >= count or listener.process.poll() is not None,
                       'all frames are heard', 30)
            listener.stop()
        equal(raw_frames(listener), wanted, 'frames on the serial line')
        equal(relay.finish(), (count, 0), 'frames through the adapters')


@check('slcan: what the tool sends on the serial line, candump sees on the kernel\'s interface, to the frame')
def _(context):
    colours = [f'{i % 256},{i // 256},7' for i in range(1000)]
    script = os.path.join(context.output or '/tmp', 'slcan.script')
    with open(script, 'w') as file:
        file.writelines(f'0s led {i % 8 + 1} {colour}\n' for i, colour in enumerate(colours))
    with Relay(context) as relay, Candump(relay.name) as judge:
        tool(context, relay, 'run', script, '--no-confirm')  # no board is there
        tool(context, relay, 'send', '1F334455#1122334455667788')
        tool(context, relay, 'send', '605#R8')
        seen = [f'{frame.id}#{frame.data}' for frame in judge.finish()]
        equal(seen[:1000], [f'{0x23C + i % 8:03X}#{i % 256:02X}{i // 256:02X}07' for i in range(1000)], 'commands')
        equal(seen[1000:], ['1F334455#1122334455667788', '605#R8'], 'frames')
        equal(relay.finish(), (0, 1002), 'frames through the adapters')


@check('slcan: a robot on the kernel\'s interface answers the tool on the serial line')
def _(context):
    with Relay(context) as relay:
        with Process(context.amiroctl, 'sim', '--bus', relay.name, listens_on=relay.name) as robot:
            for topic, frames in (('ring', 8), ('mag', 3), ('gyro', 1)):
                lines = tool(context, relay, 'once', topic, '--wait').splitlines()
                equal(len(lines), frames, f'frames of {topic}')
            equal(robot.stop(), 130, 'exit code of sim')
        kernel, mine = relay.finish()
        equal((kernel, mine), (12, 3), 'frames through the adapters')


@check('slcan: the tool makes the same error frames of an adapter\'s reports as the kernel does')
def _(context):
    # The kernel tells a state only when it is another than before. The lines of less than five characters it skips.
    reports = ['e3aaa', 'e3bcO', 'e4BfsO', 'e3bbo', 'sw096128', 'sp130130', 'sw128096', 'sp010200', 'sa012000',
               'sp200010', 'sb256256']
    master, slave = os.openpty()
    tty.setraw(slave)
    try:
        with listening(context, f'slcan:{os.ttyname(slave)}') as listener, Adapter() as adapter, \
                Candump(adapter.name) as judge:
            for report in reports:
                adapter.report(report)
                os.write(master, report.encode() + b'\r')
                time.sleep(0.02)
            eventually(lambda: len(raw_frames(listener)) >= len(reports), 'all reports are heard')
            listener.stop()
            wanted = [f'{frame.id}#{frame.data}' for frame in judge.finish()]
    finally:
        os.close(slave)
        os.close(master)
    equal(raw_frames(listener), wanted, 'error frames')
    equal(len(wanted), len(reports), 'error frames of the kernel')


@check('slcan: a line that the kernel\'s driver has is refused, with the way out')
def _(context):
    with Adapter() as adapter:
        done = subprocess.run([context.amiroctl, '--bus', f'slcan:{os.ttyname(adapter.slave)}', 'send', '123#'],
                              stdin=subprocess.DEVNULL, text=True, capture_output=True, timeout=100)
        equal(done.returncode, 1, 'exit code')
        for words in ("taken by the kernel's slcan driver", 'ip link show type can'):
            expect(words in done.stderr, f'{words!r} is not in: {done.stderr}')
