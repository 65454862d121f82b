"""What the tests of amiroctl operate share: files, and an operator that runs beside the simulated robot."""

import json
import os
import threading

from harness import SOURCE, Case

GUARD = os.path.join(SOURCE, "examples", "guard.operator.json")


def guard():
    with open(GUARD, encoding="utf-8") as file:
        return json.load(file)


class Operate(Case):
    def write(self, document, name="test.operator.json"):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(document if isinstance(document, str) else json.dumps(document, indent=1))
        return path

    def refused(self, change, *expected, code=1, document=None):
        """What is wrong once `change` was made to the guard: each text, and the line of a place in the file."""
        document = guard() if document is None else document
        change(document)
        path = self.write(document)
        _, err = self.run_tool("operate", path, "--check", code=code)
        for text in expected:
            self.assertIn(text, err)
        self.assertRegex(err, r"test\.operator\.json:\d+")
        return err

    def line_of(self, text, document):
        return next(i for i, line in enumerate(json.dumps(document, indent=1).splitlines(), 1) if text in line)


ODOMETRY = {"topic": "odometry", "period": "50ms", "priority": "high"}


HALT = {
    "name": "halt", "initial": "driving", "fall_back": "halted",
    "settle": "100ms", "retry": "500ms", "reaction": "30ms", "handling": "5ms",
    "configurations": [
        {"name": "driving", "streams": [ODOMETRY], "limits": [{"field": "motors.x", "min": "-0.1m/s", "max": "0.1m/s"}]},
        {"name": "halted", "streams": [ODOMETRY], "entry": [{"topic": "motors", "repeat": "100ms"}]},
    ],
    "monitors": [
        {"name": "too_fast", "when": {"any": ["odometry.velocity.x>0.03m/s", {"age": "odometry", "above": "400ms"}]}},
        {"name": "still", "when": "odometry.velocity.x<0.01m/s", "for": "300ms"},
    ],
    "transitions": [
        {"from": "driving", "to": "halted", "when": "too_fast"},
        {"from": "halted", "to": "driving", "when": "still"},
    ],
}


REST = "001#0000000000000000"


class Operating(Operate):
    def operate(self, *options, document=None, bus=None):
        """An operator that has begun."""
        operator = self.start(*(("--bus", bus) if bus else ()), "operate", self.write(document or HALT), "--json", *options)
        self.assertEqual(self.event(operator)["event"], "started")
        return operator

    def event(self, operator, name=None):
        """The next event, of that name. An operator that says none within a minute is killed: what it said meanwhile is in the message."""
        seen = []
        limit = threading.Timer(60, operator.kill)
        limit.start()
        try:
            for line in operator.stdout:
                event = json.loads(line)
                if name is None or event["event"] == name:
                    return event
                seen.append(line)
        finally:
            limit.cancel()
        self.fail(f"no {name or 'event'} came; the operator ended with {operator.wait()}: {''.join(seen)}{operator.stderr.read()}")

    def raw_frames(self, *topics):
        listener = self.start("listen", "--raw", "--commands", *topics)
        self.assertIn("bus: sim", listener.stderr.readline())
        self.settle()
        return listener

    def frames(self, listener):
        self.settle()  # what was sent last is on its way to the listener
        out, _ = self.interrupt(listener)
        found = []
        for line in out.splitlines():
            time, _, frame = line.split()[:3]
            found.append((float(time.strip("()")), frame))
        return found
