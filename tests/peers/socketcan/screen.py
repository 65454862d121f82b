"""What candump shows on a terminal, decoded by amiroctl: candump itself, with each option that changes a line, all at the
same time and beside one that writes a log."""
import re
import tempfile

from harness import Candump, Process, check, equal, expect
from tool import amiroctl, cansend

# Of each kind, and of a length of each kind; the last frames are a board's answers. Error frames: the first is of two
# causes, each of which -e explains in words on a line of its own.
SENT = ['000#', '7FF#0011223344556677', '205#R', '605#R3', '00000005#DE', '1F334455#1122334455667788', '1FFFFFFF#R8',
        '123##0', '123##1112233445566778899AABBCC', '1F334455##3' + '5A' * 64, '20000044#0004000000000000',
        '20000020#0000000000000000', '608#0300FFFF0000', '605#00D20000', '606#60270000', '607#2D2D2F2F']
OPTIONS = [('-t', 'a'), ('-t', 'd'), ('-t', 'z'), ('-t', 'A'), ('-x',), ('-e',), ('-a',), ('-i',), ('-S',),
           ('-t', 'a', '-x', '-a', '-e'), ('-t', 'd', '-x', '-e'), ('-t', 'z', '-a')]


def microseconds(stamp):
    seconds, digits = stamp.strip('()').split('.')
    return int(seconds) * 1_000_000 + int(digits)


@check('what candump shows is decoded to what was sent')
def _(context):
    with Candump('vcan0') as log:
        shown = [Process('candump', '-D', '-r', '8388608', *options, 'vcan0,0:0,#FFFFFFFF', listens_on='vcan0')
                 for options in OPTIONS]
        try:
            cansend(*SENT)
            for candump in shown:
                candump.settle()
                candump.stop()
            log.finish()
        finally:
            for candump in shown:
                candump.__exit__()
        logged = [line.split() for line in log.stdout.splitlines()]
    # A newer kernel marks frames of CAN FD as such, which candump writes. [linux/can.h: CANFD_FDF]
    equal([re.sub('##([4-7])', lambda flags: f'##{int(flags[1]) - 4}', frame) for _, _, frame in logged], SENT,
          'the log of candump -L')
    absolute = [microseconds(stamp) for stamp, *_ in logged]
    for options, candump in zip(OPTIONS, shown):
        what = f'candump {" ".join(options)}'
        with tempfile.NamedTemporaryFile('w') as file:
            file.write(candump.stdout)
            file.flush()
            # Nothing is left over: each line is a frame, or -e's words on one.
            out, err = amiroctl(context, 'decode', '--raw', file.name)
        expect('could not be read' not in err, f'{what}: {err}')
        lines = [line.split() for line in out.splitlines()]
        # The flags of CAN FD, and whether this machine sent it, are shown by -x only.
        extra = '-x' in options
        wanted = [frame if extra else re.sub('##.', '##0', frame) for frame in SENT]
        equal([line[1:] for line in lines], [['vcan0', frame] + (['T'] if extra else []) for frame in wanted], what)
        times = [microseconds(line[0]) for line in lines]
        if '-t' not in options:
            expected = [0] * len(SENT)
        elif options[1] in 'aA':
            expected = absolute
        else:
            expected = [time - absolute[0] for time in absolute]
        equal(times, expected, f'{what}: times')
