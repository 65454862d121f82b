"""Real dongles, played on a pseudo terminal: the base firmware (commands end with a dot) and the thesis's own (our commands,
answers in words of its own). Written from the facts on both, not from the library. Their robots are those of played_central."""

import time

from played_central import Central


class BaseFirmware(Central):
    """nrf51_multi_nus_central: AT commands; in data mode all up to a dot goes to the robot, * leads back."""

    prefixes = False

    def __init__(self, *arguments, **named):
        self.found = []
        self.unframed = []       # what went to a robot without its dot
        super().__init__(*arguments, **named)

    def serve_text(self, index, robot, text):
        return f"[{index}]:{robot.name}:{text}" if self.prefixes else text

    def answer(self, text):
        self.write(text + ".")

    def feed(self, char):
        if self.target is not None:
            if char == "*":
                self.target = None
                self.typed = ""
                return self.answer("OK")
            if char != ".":
                self.typed += char
                return None
            sentence, self.typed = self.typed, ""
            if self.target.linked:
                self.target.hear(sentence.strip(), time.monotonic())
            return None
        if char != ".":
            self.line += char
            if len(self.line) > 16:
                self.line = ""
            return None
        line, self.line = self.line, ""
        return self.execute(line)

    def execute(self, line):
        self.commands.append(line)
        if line == "AT?":
            return self.answer("OK")
        if line == "AT+SCAN+":
            self.scanning = True
            return self.answer("OK")
        if line == "AT+SCAN-":
            self.find()
            self.scanning = False
            return self.answer(f"OK-{len(self.listed)}")
        command, _, number = line.partition("=")
        if not number.isdigit() or int(number) >= len(self.listed):
            return self.answer("ERROR")
        robot = self.listed[int(number)]
        if command == "AT+FOUND":
            return self.answer(f"OK-C0000000000{number}-{robot.name}")
        if command == "AT+SWITCH":
            if not robot.linked:
                return self.answer("ERROR")
            self.target = robot
            return self.answer("OK")
        if command == "AT+CONN":
            self.answer("WAIT")
            if not robot.reachable:
                return self.answer("ERROR")
            robot.linked = True
            self.target = robot
            return self.answer("OK")
        if command == "AT+DROP":
            robot.linked = robot.confirmed = False
            self.answer("WAIT")
            return self.answer("OK")
        return self.answer("ERROR")


class Thesis(Central):
    """The changed one: start, list, stop, conn i, switch i, drop i, *; what it answers is not known but for list's lines. Asked what it is
    it says no more than has to be a line: three letters, with the first and the last that are printed."""

    line_of_three = " a~\r\n"

    def execute(self, line):
        self.commands.append(line)
        word, _, number = line.partition(" ")
        if line == "start":
            self.listed = [robot for robot in self.listed if robot.linked]
            self.scanning = True
            return self.write("Scan started.\r\n")
        if line == "stop":
            self.find()
            self.scanning = False
            return self.write(self.line_of_three)
        if line == "list":
            return self.write("".join(f"{i}:C0000000000{i}:{robot.name}\r\n" for i, robot in enumerate(self.listed)))
        if word in ("conn", "switch", "drop") and number.isdigit() and int(number) < len(self.listed):
            robot = self.listed[int(number)]
            if word == "drop":
                robot.linked = robot.confirmed = False
                return self.write("Disconnected\r\n")
            self.target = robot
            if word == "conn":
                self.scanning = False
                if robot.linked:
                    self.commands.append("HANGS")  # a wrong order
                robot.linked = robot.reachable
            return self.write("Data mode\r\n")
        return self.write(self.line_of_three)

    def feed(self, char):
        if self.target is not None and char == "*":
            self.target = None
            self.typed = ""
            return self.write("Command mode\r\n")
        return super().feed(char)


class Noise(Central):
    """A device at another speed: of what comes, no line ends with three letters."""

    def feed(self, char):
        self.write("ab\n\x01abcd\x02ab\n")


class Silent(Central):
    """A device that answers nothing: no central at all."""

    def feed(self, char):
        return None
