"""listen beside the kernel's J1939 stack: the kernel cuts messages into frames of the transport protocol, paces and answers them, and
the tool, which only listens, shows them whole. can-utils' testj1939 and j1939cat send, and sockets of this process."""
import json
import os
import re
import socket
import tempfile

from harness import Process, Vcan, check, equal, eventually, expect, sh

BROADCAST, SINGLE, OTHER = 0x0FEEC, 0x12300, 0x0EF00  # parameter groups; the last two have a destination
DBC = f'''BU_: Sender
BO_ {0x98FEECFE} Broadcast: 9 Sender
 SG_ First : 0|8@1+ (1,0) [0|0] "" Vector__XXX
 SG_ Late : 72|8@1+ (1,0) [0|0] "" Vector__XXX
BO_ {0x9923FFFE} Single: 1785 Sender
 SG_ First : 0|8@1+ (1,0) [0|0] "" Vector__XXX
 SG_ Late : 14272|8@1+ (1,0) [0|0] "" Vector__XXX
BA_DEF_ "ProtocolType" STRING ;
BA_DEF_DEF_ "ProtocolType" "J1939";
BA_ "ProtocolType" "J1939";
'''


def pattern(size, first):
    return bytes((first + 7 * i) % 251 for i in range(size))


class Node:
    """A J1939 socket of the kernel's."""
    def __init__(self, address, interface='vcan0'):
        self.socket = socket.socket(socket.PF_CAN, socket.SOCK_DGRAM, socket.CAN_J1939)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        self.socket.bind((interface, socket.J1939_NO_NAME, socket.J1939_NO_PGN, address))
        self.socket.settimeout(30)
        self.interface = interface

    def send(self, group, destination, data):
        self.socket.sendto(data, (self.interface, socket.J1939_NO_NAME, group, destination))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()


class Listener(Process):
    """amiroctl listen, with a spec that has two of the groups."""
    def __init__(self, context, *arguments):
        self.folder = tempfile.TemporaryDirectory(prefix='ocm-j1939-')
        spec = os.path.join(self.folder.name, 'truck.dbc')
        with open(spec, 'w') as file:
            file.write(DBC)
        super().__init__(context.amiroctl, '--spec', spec, '--bus', 'vcan0', 'listen', '--json', *arguments, listens_on='vcan0')
        expect(self.process.poll() is None, f'listen ended: {self.stderr}')

    def messages(self):
        """What was put together: (group, source, destination, bytes), topic, fields."""
        events = [json.loads(line) for line in self.stdout.splitlines() if line.endswith('}')]
        return [((int(found['pgn'], 16), found['source'], found['destination'], bytes.fromhex(found['data'])), found.get('topic'),
                 found.get('fields')) for event in events if (found := event.get('message'))]

    def finish(self):
        """The messages, and what the summary says of the protocol."""
        self.settle()
        equal(self.stop(), 130, f'exit code of listen ({self.stderr.strip()})')
        found = re.search(r'transport protocol of J1939: (.*)', self.stderr)
        expect(found, f'no summary: {self.stderr}')
        return self.messages(), found.group(1)


@check("listen shows can-utils' J1939 broadcast whole")
def _(context):
    with Listener(context) as listener:
        sh('testj1939', '-B', '-s20', 'vcan0:0x80', f':0xff,{BROADCAST:#x}')
        eventually(listener.messages, 'the broadcast is whole')
        (found,), summary = listener.finish()
    data = bytes.fromhex('0123456789abcdef' * 3)[:20]  # testj1939's own
    equal(found, ((BROADCAST, 0x80, 0xFF, data), 'Broadcast', {'First': 0x01, 'Late': 0x23}), 'the message')
    equal(summary, '1 message put together, 3 other frames', 'summary')


@check('listen shows J1939 connections with can-utils whole, one of the longest size')
def _(context):
    first, longest = (bytes.fromhex('0123456789abcdef') * 16), pattern(1785, 3)  # testj1939's own, the most that it sends
    with Listener(context) as listener:
        # The kernel listens on an interface from the first J1939 socket that is bound to it. (j1939cat only receives here: what this
        # kernel reports to a sender is longer than it expects.)
        with Process('j1939cat', '-r', 'vcan0:0x90', listens_on='vcan0') as receiver, Node(0x10) as node:
            def has(data):
                eventually(lambda: os.fstat(receiver.out.fileno()).st_size == len(data), 'the other end has the message')
                receiver.out.seek(0)
                equal(receiver.out.read(), data, 'what the other end received')

            sh('testj1939', f'-s{len(first)}', 'vcan0:0x80', f':0x90,{SINGLE:#x}')
            has(first)
            node.send(SINGLE, 0x90, longest)
            has(first + longest)
        eventually(lambda: len(listener.messages()) == 2, 'the connections are whole')
        found, summary = listener.finish()
    equal(found, [((SINGLE, 0x80, 0x90, first), 'Single', {'First': 0x01}),
                  ((SINGLE, 0x10, 0x90, longest), 'Single', {'First': longest[0], 'Late': longest[1784]})], 'messages')
    expect(re.fullmatch(r'2 messages? put together, \d+ other frames?', summary), f'losses: {summary}')


@check('listen tells J1939 messages of several nodes at once from one another')
def _(context):
    with Listener(context) as listener, Node(0x10) as a, Node(0x20) as b, Node(0x30) as c:
        wanted = []
        for size in (9, 14, 15, 62, 250):  # the kernel queues what one node sends to another
            for node, source, group, destination in ((a, 0x10, SINGLE, 0x20), (b, 0x20, OTHER, 0x10), (c, 0x30, BROADCAST, 0xFF),
                                                     (a, 0x10, OTHER, 0x30)):
                data = pattern(size, source + destination)
                node.send(group, destination, data)
                wanted.append((group, source, destination, data))
        eventually(lambda: len(listener.messages()) >= len(wanted), 'all are whole', limit=60)
        found, summary = listener.finish()
    equal(sorted(message for message, *_ in found), sorted(wanted), 'messages')
    for (group, *_, data), topic, fields in found:
        equal(topic, {SINGLE: 'Single', BROADCAST: 'Broadcast'}.get(group), 'topic')
        if group != OTHER:
            late = {'Late': data[9]} if group == BROADCAST and len(data) > 9 else {}
            equal(fields, {'First': data[0]} | late, 'fields')
    expect(re.fullmatch(rf'{len(wanted)} messages? put together, \d+ other frames?', summary), f'losses: {summary}')


@check('listen counts a J1939 connection that is not answered')
def _(context):
    with Listener(context, '--strict', '--timeout', '20s') as listener, Node(0x10) as node:
        node.send(SINGLE, 0x77, pattern(100, 1))
        eventually(lambda: listener.stdout.count('"transport":"control"') >= 2, 'the kernel gives up', limit=30)
        listener.settle()
        listener.stop()
        expect(re.search(r'0 messages? put together, \d+ other frames?, 1 (timed out|aborted)', listener.stderr), f'summary: {listener.stderr}')


@check('the kernel puts together what set broadcasts by J1939')
def _(context):
    with tempfile.TemporaryDirectory(prefix='ocm-j1939-') as folder, Node(0x10) as node:
        spec = os.path.join(folder, 'sender.dbc')
        with open(spec, 'w') as file:
            file.write(DBC.replace(str(0x98FEECFE), str(0x98FEEC2A)).replace('Broadcast: 9', 'Broadcast: 100'))
        sh(context.amiroctl, '--spec', spec, '--bus', 'vcan0', 'set', 'Broadcast', 'First=1', 'Late=0x63', '--every', '800ms',
           '--for', '1s')
        wanted = bytes([1]) + bytes(8) + bytes([0x63]) + bytes(90)
        for _ in range(2):
            data, (_, _, group, source) = node.socket.recvfrom(2000)
            equal((data, group, source), (wanted, BROADCAST, 0x2A), 'the message')
