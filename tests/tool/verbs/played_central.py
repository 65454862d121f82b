"""A central with mappers, played on a pseudo terminal: what the verbs for mappers talk to in tests. Written from
docs/mapper-link.md, not from the library: commands, answers, packets of 20 bytes with their prefix; robots that shake hands,
drive in a rectangular room on command, and see its walls."""

import contextlib
import fcntl
import math
import os
import random
import select
import socket
import threading
import time
import tty


class Robot:
    def __init__(self, name, pose=(0.0, 0.0, 0.0), room=(0.0, 0.0, 1.2, 1.0)):
        self.name = name
        self.start = pose
        self.x, self.y, self.heading = pose
        self.room = room
        self.linked = self.confirmed = self.paused = False
        self.reachable = True
        self.deaf = False        # hears nothing
        self.loses = 0           # so many of its next set points
        self.silent = False      # says nothing
        self.deadline_ms = 2000  # after so long without a word it is lost, as its handshake says
        self.mumbles = False     # says that it is idle, but never where it is
        self.repeats_idle = False  # says that it is idle behind each update, too, and both at once
        self.knows_who = True    # and answers {S,WHO},
        self.who_late = 0.0      # so many seconds later
        self.knows_compass = True  # and {C,number}
        self.calibration = 0     # number of the last one
        self.compass = (0, 0, 0, 0, 0, 0)       # what it says of that: verdict, x, y, field, error, use
        self.finds = [(2, 41, -57, 152, 1, 2)]  # what it says after a turn, one after the other
        self.turn_s = 1.0
        self.turning_until = None
        self.blocked_cm = None   # stops after so many cm
        self.slides_cm = 0       # so far ahead, once, from where it heard "stop" to where it stands
        self.told_to_stop = False
        self.bad_beyond_cm = None  # farther from where it was switched on half of its packets are lost
        self.chance = random.Random(7)
        self.busy_until = 0.0
        self.speed = 100.0       # cm/s
        self.servo, self.step = 0, 10
        self.heard = []
        self.spoke = 0.0
        self.idled = 0.0
        self.asked = self.asked_compass = False
        self.asked_at = 0.0      # the first time since it answered

    def hear(self, line, now):
        self.heard.append(line)
        if self.deaf:
            return
        if line.startswith("{U,") and self.loses:
            self.loses -= 1
            return
        if line == "{S,CON}":
            self.confirmed = True
        elif line == "{S,PAU}":
            self.paused = True
        elif line == "{S,UNP}":
            self.paused = False
        elif line == "{S,WHO}" and self.knows_who:
            self.asked_at = self.asked_at if self.asked else now
            self.asked = True
        elif line.startswith("{C,"):
            self.hear_calibrate(int(line[3:-1]), now)
        elif line == "{U,0,0}" and self.turning_until is not None:
            self.compass, self.turning_until, self.idled = (4, 0, 0, 0, 0, 0), None, 0.0
        elif line.startswith("{U,"):
            angle, distance = map(int, line[3:-1].split(","))
            self.heading += math.radians(angle)
            if self.blocked_cm is not None:
                distance = min(distance, self.blocked_cm)
            way = min(distance / 100, self.ray(self.heading) - 0.12)
            self.x += way * math.cos(self.heading)
            self.y += way * math.sin(self.heading)
            self.busy_until = now + (max(0.0, distance / self.speed) + 0.4 if line != "{U,0,0}" else 0.0)
            self.told_to_stop = line == "{U,0,0}"
            self.idled = 0.0

    def hear_calibrate(self, number, now):
        if not self.knows_compass or not self.confirmed or self.loses:
            self.loses -= 1 if self.loses else 0
            return
        if number not in (0, self.calibration):
            if self.paused:
                return
            self.calibration, self.turning_until = number, now + self.turn_s
        self.asked_compass = True

    def is_heard(self):
        """Whether its next packet is."""
        far = 100 * math.hypot(self.x - self.start[0], self.y - self.start[1])
        return self.bad_beyond_cm is None or far <= self.bad_beyond_cm or self.chance.random() >= 0.5

    def say_compass(self):
        said = (1, 0, 0, 0, 0, 0) if self.turning_until is not None else self.compass
        self.asked_compass = False
        return "{C," + ",".join(map(str, (self.calibration, *said))) + "}\n"

    def say_turning(self, now):
        """While it turns it says that, and nothing else."""
        text = self.say_compass() if self.asked_compass or now - self.spoke >= 1 else ""
        self.spoke = now if text else self.spoke
        if now >= self.turning_until:
            self.turning_until, self.idled = None, now
            self.compass = self.finds[0]
            text = self.say_compass() + "{S,IDL}\n"
        return text

    def ray(self, angle):
        x0, y0, x1, y1 = self.room
        ways = []
        c, s = math.cos(angle), math.sin(angle)
        if c > 1e-9: ways.append((x1 - self.x) / c)
        if c < -1e-9: ways.append((x0 - self.x) / c)
        if s > 1e-9: ways.append((y1 - self.y) / s)
        if s < -1e-9: ways.append((y0 - self.y) / s)
        return min(way for way in ways if way >= -1e-9)

    def update(self):
        dx, dy = self.x - self.start[0], self.y - self.start[1]
        c, s = math.cos(self.start[2]), math.sin(self.start[2])
        degrees = round(math.degrees(self.heading - self.start[2]))
        degrees = (degrees + 180) % 360 - 180
        seen = []
        for k in range(4):
            way = self.ray(self.heading + math.radians(90 * k + self.servo))
            seen.append(round(100 * way) if 0.05 <= way <= 0.8 else 0)
        values = [round(100 * (c * dx + s * dy)), round(100 * (c * dy - s * dx)), degrees, self.servo, *seen]
        self.servo += self.step
        if self.servo in (0, 90):
            self.step = -self.step
        return "{U," + ",".join(map(str, values)) + "}\n"

    def say(self, now):
        """What it has to say now."""
        if self.silent:
            return ""
        handshake = f"{{H,20,20,0,0,0,90,180,270,{self.deadline_ms},0}}\n"
        if not self.confirmed:
            if now - self.spoke < 0.3:
                return ""
            self.spoke = now
            return handshake
        if self.turning_until is not None:
            return self.say_turning(now)
        if len(self.finds) > 1 and self.asked_compass and self.compass == self.finds[0]:
            self.finds.pop(0)
            self.compass = self.finds[0]
        text = self.say_compass() if self.asked_compass else ""
        if self.asked and now - self.asked_at >= self.who_late:
            text += handshake
            self.asked = False
        if not self.paused and not self.mumbles and now - self.spoke >= 0.05:
            self.spoke = now
            text += self.update()
            self.idled = 0.0 if self.repeats_idle else self.idled
        if now >= self.busy_until and now - self.idled >= 0.5:
            self.idled = now
            text += "{S,IDL}\n"
            if self.told_to_stop and self.slides_cm:
                self.x += self.slides_cm / 100
                self.slides_cm = 0
                self.spoke = now + 0.3  # when it says so
        return text


class Central:
    """Serves until `close`. `path` is what a program opens; `robots` may be changed meanwhile."""

    def __init__(self, folder, robots, link="central"):
        self.robots = robots
        self.listed = []
        self.target = None       # data mode
        self.scanning = False
        self.line = self.typed = ""
        self.mute = False        # answers no command
        self.slow = 0.0          # s that it is late with its first answer
        self.commands = []
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.path = os.path.join(folder, link)
        os.makedirs(os.path.dirname(self.path), mode=0o700, exist_ok=True)
        self.lock = os.open(self.path + ".lock", os.O_RDWR | os.O_CREAT, 0o600)
        fcntl.flock(self.lock, fcntl.LOCK_EX)  # who serves a line holds it; a killed one does not
        os.symlink(os.ttyname(self.slave), self.path)
        self.over = False
        self.babbler = None
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def close(self):
        self.over = True
        while self.babbler is not None and self.babbler.is_alive():
            if select.select([self.slave], [], [], 0.01)[0]:
                os.read(self.slave, 65536)  # its last words, which wait
        self.thread.join(5)
        for file in (self.master, self.slave, self.lock):
            if file is not None:
                os.close(file)
        self.master = self.slave = self.lock = None

    def unplug(self):
        """The device goes while programs have it open."""
        self.over = True
        self.thread.join(5)
        os.close(self.master)
        self.master = None

    def write(self, text):
        if not self.mute:
            os.write(self.master, text.encode())

    def babble(self):
        """Noise between its words, without end and faster than it is read."""
        def noise():
            while not self.over:
                os.write(self.master, b"xyz{U,1,2[0]:AVR:" * 100)
        self.babbler = threading.Thread(target=noise, daemon=True)
        self.babbler.start()

    def abandon(self):
        """As if its program had been killed, and the terminal been given to another: link and lock file stay."""
        os.close(self.lock)
        self.lock = None

    def drop(self, robot):
        robot.linked = robot.confirmed = False
        self.write(f"lost {self.listed.index(robot)}\n")

    def find(self):
        """What is near, during a scan: also one whose end comes before this thread has run."""
        if self.scanning:
            self.listed += [robot for robot in self.robots if robot not in self.listed]

    def serve(self):
        while not self.over:
            ready, _, _ = select.select([self.master], [], [], 0.01)
            if ready:
                time.sleep(self.slow)  # how late it answers
                self.slow = 0.0
                for char in os.read(self.master, 4096).decode("latin-1"):
                    self.feed(char)
            now = time.monotonic()
            self.find()
            for index, robot in enumerate(self.listed):
                text = robot.say(now) if robot.linked else ""
                heard = [self.serve_text(index, robot, text[at:at + 20]) for at in range(0, len(text), 20) if robot.is_heard()]
                for part in ["".join(heard)] if robot.repeats_idle else heard:
                    self.write(part)

    def serve_text(self, index, robot, text):
        """A packet of a robot as it goes to the server."""
        return f"[{index}]:{robot.name}:{text}"

    def feed(self, char):
        if self.target is not None:
            if char == "*":
                self.target = None
                self.typed = ""
                return self.write("command\n")
            self.typed += char
            if char == "\n":
                if self.target.linked:
                    self.target.hear(self.typed.strip(), time.monotonic())
                self.typed = ""
            return None
        if char == "\n":
            line, self.line = self.line, ""
            return self.execute(line) if line else None
        if char != "*" or self.line:
            self.line += char
        return None

    def execute(self, line):
        self.commands.append(line)
        word, _, number = line.partition(" ")
        if line == "start":
            self.listed = [robot for robot in self.listed if robot.linked]
            self.scanning = True
            return self.write("scanning\n")
        if line == "stop":
            self.find()
            self.scanning = False
            return self.write(f"found {len(self.listed)}\n")
        if line == "list":
            entries = [f"{i}:C0000000000{i}:{robot.name}\n" for i, robot in enumerate(self.listed)]
            return self.write("".join(entries) + "end of list\n")
        if word in ("conn", "switch", "drop"):
            if not number.isdigit() or int(number) >= len(self.listed):
                return self.write("error: not in the list; see list\n")
            robot = self.listed[int(number)]
            if word == "drop":
                robot.linked = robot.confirmed = False
                return self.write(f"closing {number}\nclosed {number}\n")
            if word == "switch" and not robot.linked:
                return self.write(f"error: no link to {number}; conn first\n")
            self.target = robot
            if robot.linked:
                return self.write(f"data {number}\n")
            self.scanning = False
            self.write(f"connecting {number}\n")
            if not robot.reachable:
                return self.write(f"error: no link to {number}\n")
            robot.linked = True
            return self.write(f"connected {number}\n")
        return self.write("error: start, list, stop, conn i, switch i, drop i, *, reset\n")


def row(**values):
    """What the program that has the line says of the AVR, which has a link and has said something; with these values, too."""
    usual = {"index": 0, "address": "C00000000000", "name": "AVR", "linked": 1, "confirmed": 1, "last": "idle"}
    return "\t".join(f"{key}={value}" for key, value in (usual | values).items()) + "\n"


class Owner:
    """A program that has a central's line: others join it, one after the other. `heard` is what they ask. It knows one robot at most:
    `robot` makes its row of what was asked so far."""

    def __init__(self, folder, line):
        digits = 0x811C9DC5  # of the line's path, in the name of the socket [FNV-1a]
        for byte in os.path.realpath(line).encode():
            digits = (digits ^ byte) * 0x01000193 & 0xFFFFFFFF
        self.heard = []
        self.robot = lambda heard: ""
        self.ordered = b"ok\n1"  # what it answers to each order: its number, or why it is refused
        self.server = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.server.bind(os.path.join(folder, f"line-{digits:08x}.sock"))
        self.server.listen()
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def close(self):
        self.server.shutdown(socket.SHUT_RDWR)  # it takes no more programs
        self.server.close()

    def looks(self):
        """The requests to look for robots, with their time in milliseconds."""
        return [request for request in self.heard if request.startswith("scan ")]

    def serve(self):
        while True:
            try:
                caller, _ = self.server.accept()
            except OSError:
                return
            with caller, contextlib.suppress(OSError):
                while request := caller.recv(65536).decode():
                    self.heard.append(request)
                    caller.send(self.answer(request))

    def answer(self, request):
        if request.startswith("robots"):
            return f"ok\nidle\n{self.robot(self.heard)}".encode()
        if request.startswith(("go ", "stop ", "calibrate ")):
            return self.ordered
        return b"no\nit draws none\n" if request.startswith("map") else b"ok\nplayed"
