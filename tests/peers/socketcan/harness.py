"""What the checks share: a list of checks, processes, candump, and a serial CAN adapter played on a pty."""
import collections
import ctypes
import fcntl
import os
import re
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
import traceback
import tty

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..'))
import realtime
import waiting

Frame = collections.namedtuple('Frame', 'time id data')  # as candump -L writes them: seconds, hex, hex
checks = []


def check(title):
    """Registers a function that raises when the check fails."""
    def register(function):
        checks.append((title, function))
        return function
    return register


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def equal(got, wanted, what):
    expect(got == wanted, f'{what}: got {got!r} instead of {wanted!r}')


def interfaces():
    return set(os.listdir('/sys/class/net'))


def attempt(function, context, tries=5):
    """What is wrong, None: nothing. As realtime.py does: again where this machine held up a thread for long. Compilers may be
    beside all of it for minutes."""
    for left in reversed(range(tries)):
        before = interfaces()
        try:
            with realtime.Spare() as context.spare:
                function(context)
            return None
        except Exception as error:  # a check must not take the others with it
            text = str(error) if isinstance(error, AssertionError) else traceback.format_exc()
        for name in interfaces() - before:  # of a program that was killed; some go by themselves
            subprocess.run(['ip', 'link', 'delete', name], check=False)
        text = '\n'.join('#   ' + line for line in text.splitlines())
        late = context.spare.late
        if late < realtime.MOST_LATE or not left:
            return text
        print(f'{text}\n#   again: meanwhile a thread woke {late * 1000:.0f} ms late', flush=True)
        realtime.until_calm()


def run_all(selected, context):
    """Runs the checks whose title contains `selected`; returns the number that failed."""
    chosen = [(title, function) for title, function in checks if selected in title]
    print(f'1..{len(chosen)}', flush=True)
    failures = 0
    for number, (title, function) in enumerate(chosen, 1):
        begin = time.monotonic()
        text = attempt(function, context)
        if text is None:
            print(f'ok {number} - {title} ({time.monotonic() - begin:.1f} s)', flush=True)
            continue
        failures += 1
        print(f'not ok {number} - {title}')
        print(text, flush=True)
    if not chosen:
        print('Bail out! no check has this title')
        return 1
    return failures


def eventually(holds, what, limit=30):
    waiting.until(holds, what, limit)


def sh(*command):
    """Runs a command that must succeed; returns its stdout."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300)
    expect(done.returncode == 0, f'{" ".join(command)}: exit {done.returncode}: {done.stderr.strip()}')
    return done.stdout


def listeners(interface):
    """How many receive filters are registered on an interface."""
    count = 0
    for name in os.listdir('/proc/net/can'):
        if name.startswith('rcvlist_') and name != 'rcvlist_err':
            with open('/proc/net/can/' + name) as file:
                count += len(re.findall(rf'^ *{interface} ', file.read(), re.M))
    return count


class Process:
    """A program in the background; stdout and stderr go to files."""
    def __init__(self, *command, listens_on=None, **options):
        self.command = ' '.join(command)
        self.out = tempfile.TemporaryFile()
        self.err = tempfile.TemporaryFile()
        before = listeners(listens_on) if listens_on else 0
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=self.out, stderr=self.err, **options)
        if listens_on:
            eventually(lambda: listeners(listens_on) > before or self.process.poll() is not None,
                       f'{self.command} listens on {listens_on}')

    stdout = property(lambda self: waiting.printed(self.out))
    stderr = property(lambda self: waiting.printed(self.err))

    def send_signal(self, number):
        self.process.send_signal(number)

    def wait(self, limit=90):
        """The exit code; 128 + signal when a signal ended it."""
        try:
            code = self.process.wait(limit)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            raise AssertionError(f'{self.command}: still runs after {limit} s; stderr: {self.stderr}') from None
        return 128 - code if code < 0 else code

    def settle(self, looks=20):
        """Returns when it has read all that there was, and waits for more: nothing runs on its way to it any longer."""
        waiting.until_asleep(self.process.pid, looks=looks, limit=120)

    def stop(self, number=signal.SIGINT):
        if self.process.poll() is None:
            self.send_signal(number)
        return self.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


class Candump(Process):
    """candump's log of an interface, error frames too; it goes on when the interface goes down."""
    def __init__(self, interface):
        # -r: a judge that loses frames itself, when the guest is slow, judges nothing
        super().__init__('candump', '-L', '-D', '-r', '8388608', f'{interface},0:0,#FFFFFFFF', listens_on=interface)

    def frames(self):
        lines = re.findall(r'^\(([0-9.]+)\) \S+ ([0-9A-F]+)#(\S*)', self.stdout, re.M)
        return [Frame(float(stamp), number, data) for stamp, number, data in lines]

    def finish(self):
        """All frames, once it has printed what is still in its queue."""
        self.settle()
        self.stop()
        return self.frames()


class Vcan:
    """A virtual CAN interface that goes with the check."""
    def __init__(self, name, up=True):
        self.name = name
        sh('ip', 'link', 'add', name, 'type', 'vcan')
        if up:
            self.up()

    def up(self):
        sh('ip', 'link', 'set', self.name, 'up')

    def down(self):
        sh('ip', 'link', 'set', self.name, 'down')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        subprocess.run(['ip', 'link', 'del', self.name], stderr=subprocess.DEVNULL)


class Adapter:
    """A serial CAN adapter (SLCAN): the kernel's driver on the far end of a pty, the check plays the device."""
    N_SLCAN = 17         # linux/tty.h
    SIOCGIFNAME = 0x8910

    def __init__(self):
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        fcntl.ioctl(self.slave, termios.TIOCSETD, struct.pack('i', self.N_SLCAN))
        self.name = fcntl.ioctl(self.slave, self.SIOCGIFNAME, bytes(64)).split(b'\0')[0].decode()
        # The driver opens the channel with commands, and waits until they are read.
        opening = threading.Thread(target=lambda: self.sent(2, b'O\r'))
        opening.start()
        sh('ip', 'link', 'set', self.name, 'up', 'type', 'can', 'bitrate', '500000')
        opening.join()

    def report(self, line):
        os.write(self.master, line.encode() + b'\r')

    def sent(self, quiet=2.0, last=None):
        """What the host has sent, until nothing came for a while."""
        data = b''
        while select.select([self.master], [], [], quiet)[0]:
            data += os.read(self.master, 4096)
            if last and data.endswith(last):
                break
        return data.decode()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.slave)
        os.close(self.master)


def forbid_can_sockets():
    """For preexec_fn: from now on socket(AF_CAN) fails with EPERM, as in a sandbox. x86-64, as the guest is."""
    load, jump_if_equal, leave = 0x20, 0x15, 0x06
    SYS_socket, AF_CAN, EPERM, allow, fail = 41, 29, 1, 0x7FFF0000, 0x00050000
    program = [(load, 0, 0, 0), (jump_if_equal, 0, 3, SYS_socket),   # seccomp_data.nr
               (load, 0, 0, 16), (jump_if_equal, 0, 1, AF_CAN),      # seccomp_data.args[0]
               (leave, 0, 0, fail | EPERM), (leave, 0, 0, allow)]
    code = ctypes.create_string_buffer(b''.join(struct.pack('=HBBI', *line) for line in program))
    header = ctypes.create_string_buffer(struct.pack('@HP', len(program), ctypes.addressof(code)))
    libc = ctypes.CDLL(None, use_errno=True)
    PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 38, 22, 2
    if libc.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) or libc.prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, header, 0, 0):
        raise OSError(ctypes.get_errno(), 'prctl')


def as_nobody(*command):
    return ('setpriv', '--reuid=65534', '--regid=65534', '--clear-groups', *command)
