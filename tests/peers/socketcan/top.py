"""amiroctl top on CAN interfaces of the kernel: frames of can-utils, and the controller's state, which the kernel says over
netlink without any error frame. The terminal is a pseudo terminal; what is drawn first is whole."""
import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios

from harness import Adapter, check, equal, eventually, expect, listeners, sh
from tool import cansend


class Screen:
    """top on a terminal of 100 by 24; `text` is all that it has drawn, without the terminal's sequences."""
    def __init__(self, context, interface):
        self.primary, secondary = pty.openpty()
        fcntl.ioctl(secondary, termios.TIOCSWINSZ, struct.pack('HHHH', 24, 100, 0, 0))
        self.drawn = b''
        before = listeners(interface)
        self.process = subprocess.Popen([context.amiroctl, '--bus', interface, 'top'], stdin=secondary, stdout=secondary,
                                        stderr=subprocess.PIPE, env={**os.environ, 'TERM': 'xterm'}, start_new_session=True)
        os.close(secondary)
        eventually(lambda: listeners(interface) > before or self.process.poll() is not None, 'top listens')
        expect(self.process.poll() is None, 'top ended')

    def text(self):
        while select.select([self.primary], [], [], 0)[0]:
            try:
                self.drawn += os.read(self.primary, 65536)
            except OSError:  # it has ended
                break
        return re.sub(r'\x1b\[[0-9;?]*[A-Za-z]|\x1b[()][A-Z0-9]|\x1b[=>]', ' ', self.drawn.decode(errors='replace'))

    def shows(self, *parts):
        eventually(lambda: all(part in self.text() for part in parts), f'{parts} on the screen')

    def quit(self):
        os.write(self.primary, b'q')
        eventually(lambda: (self.text(), self.process.poll())[1] is not None, 'top ends')
        equal(self.process.returncode, 0, 'exit code of top')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGKILL)
            self.process.wait()
        os.close(self.primary)


@check('top on a CAN interface shows what can-utils send, and what it does not know')
def _(context):
    with Screen(context, 'vcan0') as screen:
        screen.shows('vcan0', 'nothing came yet')
        cansend('608#0300FFFF0000', '123#DEAD')
        screen.shows('gyroscope', '123')
        expect('error active' not in screen.text(), 'a virtual interface has no controller')
        screen.quit()


@check('top shows the controller\'s state, which the kernel says without an error frame')
def _(context):
    with Adapter() as adapter:
        with Screen(context, adapter.name) as screen:
            screen.shows(adapter.name, 'error active')
            screen.quit()
        # States that were there before top came: no error frame is on its way to it any more.
        for report, state, words in (('sp200100', 'ERROR-PASSIVE', 'error passive'), ('sb256000', 'BUS-OFF', 'bus-off')):
            adapter.report(report)
            eventually(lambda state=state: state in sh('ip', '-details', 'link', 'show', adapter.name), state)
            with Screen(context, adapter.name) as screen:
                screen.shows(words)
                screen.quit()
