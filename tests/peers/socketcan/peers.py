"""The library's SocketCan against can-utils and python-can."""
import subprocess

import can

from harness import Process, as_nobody, check, equal, expect, forbid_can_sockets


def catch2(*command, **options):
    """Runs a Catch2 program and shows what it says of a failure."""
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=600, **options)
    expect(done.returncode == 0, f'{" ".join(command)}: exit {done.returncode}\n{done.stdout}')
    expect('All tests passed' in done.stdout, f'no test ran: {done.stdout}')


@check('SocketCan against can-utils and the kernel')
def _(context):
    catch2(context.peer)


@check('SocketCan without privileges')
def _(context):
    catch2(*as_nobody(context.peer, '[plain]'))


@check('SocketCan where CAN sockets are forbidden')
def _(context):
    catch2(context.peer, '[.forbidden]', preexec_fn=forbid_can_sockets)


@check('python-can and SocketCan read each other')
def _(context):
    sent = [can.Message(arbitration_id=number, is_extended_id=number > 0x7FF, is_remote_frame=remote, dlc=length,
                        data=None if remote else bytes(range(1, length + 1)))
            for number in (0, 0x205, 0x7FE, 0x800, 0x1FFFFFFF) for remote in (False, True) for length in (0, 3, 8)]
    with can.Bus(interface='socketcan', channel='vcan0') as bus, \
            Process(context.peer, '[.echo]', listens_on='vcan0') as echo:
        for message in sent:
            bus.send(message)
            answer = bus.recv(5)
            expect(answer is not None, f'no answer to {message}')
            wanted = (message.arbitration_id ^ 1, message.is_extended_id, message.is_remote_frame, message.dlc,
                      bytes(message.data))
            equal((answer.arbitration_id, answer.is_extended_id, answer.is_remote_frame, answer.dlc,
                   bytes(answer.data)), wanted, f'answer to {message}')
        bus.send(can.Message(arbitration_id=0x7FF, is_extended_id=False))
        equal(echo.wait(), 0, f'exit code of the peer: {echo.stdout}')
