"""Every verb with nothing, a misspelt option, a word too many and a wrong value: the whole messages."""

import re

from harness import Case, main

# What is typed, what is said is wrong, and the remedy. A new verb gets rows of its own. What an option was called before is
# not offered.
MISUSE = """
list --jsn
list: unknown option '--jsn'
did you mean '--json'?

list gyro
list: unexpected argument 'gyro'
usage: amiroctl list [OPTION ...]

list --json=maybe
list: --json maybe: neither true nor false
a flag takes no value, or true or false

list --bus
list: missing value for --bus
usage: --bus NAME

info
info: missing TOPIC
usage: amiroctl info TOPIC [OPTION ...]

info gyro --jsn
info: unknown option '--jsn'
`amiroctl info --help` lists the options

info gyro odom
info: unexpected argument 'odom'
usage: amiroctl info TOPIC [OPTION ...]

info gyr
info: no topic 'gyr'
did you mean 'gyro'?

info 8
info: no topic '8'
did you mean '0x08' (gyroscope)?

info 30
info: no topic '30'
did you mean '0x1E' (power_status)?

analyse
analyse: missing VERB
usage: amiroctl analyse bus|tasks|chain|trace ...

analyse --wat
analyse: unknown option '--wat'
`amiroctl analyse --help` lists the options

analyse buss
analyse: unknown verb 'buss'
did you mean 'bus'?

analyse bus --rats gyro=1s
analyse bus: unknown option '--rats'
did you mean '--rates'?

analyse bus a b
analyse bus: unexpected argument 'b'
usage: amiroctl analyse bus [FILE] [OPTION ...]

analyse bus --bitrate 2M
analyse bus: --bitrate 2M: no bit rate of CAN
1 to 1000000 bits a second, such as 500k or 125000

analyse bus --lengths
analyse bus: missing value for --lengths
usage: --lengths generic|exact

analyse bus --lengths exakt
analyse bus: --lengths exakt: unknown value
did you mean 'exact'?

analyse bus --json --csv
analyse bus: --json and --csv exclude each other
use one of them

analyse tasks
analyse tasks: missing FILE|BOARD
usage: amiroctl analyse tasks FILE|BOARD [OPTION ...]

analyse tasks x --tik 1ms
analyse tasks: unknown option '--tik'
did you mean '--tick'?

analyse tasks a b
analyse tasks: unexpected argument 'b'
usage: amiroctl analyse tasks FILE|BOARD [OPTION ...]

analyse tasks a --tick soon
analyse tasks: --tick soon: not a time
write 500ms, 2s or 1.5s

analyse tasks a --tick-cost 1us
analyse tasks: --tick-cost needs --tick
add --tick, or drop --tick-cost

analyse chain
analyse chain: missing FILE
usage: amiroctl analyse chain FILE [OPTION ...]

analyse chain x --deadlin 1s
analyse chain: unknown option '--deadlin'
did you mean '--deadline'?

analyse chain a b
analyse chain: unexpected argument 'b'
usage: amiroctl analyse chain FILE [OPTION ...]

analyse chain a --deadline soon
analyse chain: --deadline soon: not a time
write 500ms, 2s or 1.5s

analyse trace
analyse trace: missing LOG
usage: amiroctl analyse trace LOG [OPTION ...]

analyse trace x --st y
analyse trace: unknown option '--st'
did you mean '--set'?

analyse trace a b
analyse trace: unexpected argument 'b'
usage: amiroctl analyse trace LOG [OPTION ...]

analyse trace a --test exakt
analyse trace: --test exakt: unknown value
did you mean 'exact'?

generate
generate: missing TARGET
usage: amiroctl generate TARGET [OPTION ...]

generate dbc --priorty low
generate: unknown option '--priorty'
did you mean '--priority'?

generate dbc c
generate: unexpected argument 'c'
usage: amiroctl generate TARGET [OPTION ...]

generate dbx
generate: unknown target 'dbx'
did you mean 'dbc'?

generate dbc --priority lo
generate: --priority lo: not a priority
write urgent, high, medium or low, or 0 to 3

generate c --priority low
generate c: --priority is for dbc
drop --priority

publish
publish: missing TOPIC
usage: amiroctl publish TOPIC [PERIOD]

publish gyro --priorty low
publish: unknown option '--priorty'
did you mean '--priority'?

publish gyro mag 500ms
publish: 'mag' is a second topic
one topic a command: give one for each

publish gyro 20Hz
publish: '20Hz' is a rate
write its period, 50ms

publish gyro 1.5kHz
publish: '1.5kHz' is a rate
write its period, 667us

publish gyro 1s 2s
publish: unexpected argument '2s'
usage: amiroctl publish TOPIC [PERIOD]

publish gyro 500 ms
publish: unexpected argument 'ms'
write it as one word, 500ms

drive 5 cm/s 10 deg/s
drive: unexpected argument '10'
write it as one word, 5cm/s

travel 30 cm
travel: unexpected argument 'cm'
write it as one word, 30cm

publish gyro 500
publish: '500' needs a unit: us, ms or s
write 500ms, 2s or 900us

publish 1F 1s
publish: no topic '1F'
did you mean '0x1F' (proximity_ring)?

publish gyr
publish: no topic 'gyr'
did you mean 'gyro'?

publish gyro --priority top
publish: --priority top: not a priority
write urgent, high, medium or low, or 0 to 3

publish gyro --wait soon
publish: --wait soon: not a time above zero
write 2s, 500ms or 1min

publish gyro --listen soon
publish: --listen soon: not a time
write 500ms, 2s or 1.5s

publish gyro --priority high --priority low
publish: --priority is given more than once
give it once

once
once: missing TOPIC
usage: amiroctl once TOPIC

once gyro --wiat
once: unknown option '--wiat'
did you mean '--wait'?

once gyro 1s
once: unexpected argument '1s'
usage: amiroctl once TOPIC

once gyro --wait soon
once: --wait soon: not a time above zero
write 2s, 500ms or 1min

stop gyro --dryrun
stop: unknown option '--dryrun'
did you mean '--dry-run'?

set travel distance=10cm angle=0rad speed=10cm/s --every 500ms
set: travel is not set again and again
each set point begins it again, and it goes on without this program: set it once

stop gyro now
stop: unexpected argument 'now'
usage: amiroctl stop [TOPIC|all]

stop gyro odom
stop: 'odom' is a second topic
one topic a command: give one for each

stop gyr
stop: no topic 'gyr'
did you mean 'gyro'?

stop gyro --priority top
stop: --priority top: not a priority
write urgent, high, medium or low, or 0 to 3

drive
drive: missing X|stop
usage: amiroctl drive X|stop [Z]

drive 1 --fro 2s
drive: unknown option '--fro'
did you mean '--for'?

drive 1 2 3
drive: unexpected argument '3'
usage: amiroctl drive X|stop [Z]

drive stop 1
drive: drive stop takes no velocity and no --for
usage: amiroctl drive stop

drive 1 --for 0s
drive: --for 0s: not a time above zero
write 2s, 500ms or 1min

drive 1 --for 2s --once
drive: --for and --once exclude each other
use one of them

travel
travel: nowhere to go
usage: amiroctl travel [DISTANCE] [--turn ANGLE], for example 30cm

travel --sped 5cm/s
travel: unknown option '--sped'
did you mean '--speed'?

travel 30
travel: '30' needs a unit: distance takes -10 to 10 m
write 30cm, -0.3m or 50mm; an angle is --turn 90deg

travel 30cm 5cm
travel: unexpected argument '5cm'
usage: amiroctl travel [DISTANCE] [OPTION ...]

behave
behave: missing follow|avoid|home|none
usage: amiroctl behave follow|avoid|home|none [OPTION ...]

behave follow --sped 5cm/s
behave: unknown option '--sped'
did you mean '--speed'?

behave fly
behave: unknown behaviour 'fly'
one of: follow, avoid, home, none

behave none 2s
behave: unexpected argument '2s'
usage: amiroctl behave follow|avoid|home|none [OPTION ...]

behave none --for 2s
behave: none takes no --for
drop --for

led
led: missing N|all
usage: amiroctl led N|all COLOUR|off

led 1
led: missing COLOUR|off
usage: amiroctl led N|all COLOUR|off

led 1 red --dry
led: unknown option '--dry'
did you mean '--dry-run'?

led 1 red 2
led: unexpected argument '2'
usage: amiroctl led N|all COLOUR|off

led 9 red
led: no LED '9'
1 to 8, or all

led 1 reddish
led: 'reddish' is not a colour
write 100,50,120 or #643278 or a name such as red, white, off

set
set: missing ACTUATOR|MESSAGE
usage: amiroctl set ACTUATOR|MESSAGE [FIELD=VALUE ...]

set motors x=1 --dri-run
set: unknown option '--dri-run'
did you mean '--dry-run'?

set motors x
set: 'x' is not of the form FIELD=VALUE
write a value behind it: x=0

set motors y=1
set: motors has no field 'y'
did you mean 'x'?

set gyro x=1
set: 'gyro' is a sensor
sensors are asked with publish, once and stop

send
send: missing FRAME
usage: amiroctl send FRAME

send 123# --stdn
send: unknown option '--stdn'
did you mean '--stdin'?

send 123# 124#
send: unexpected argument '124#'
usage: amiroctl send FRAME

send 123
send: '123': not of the expected form
write 205#01840302 (three hex digits, or eight for an extended identifier), 205#R, or 205##101840302 for CAN FD

send --stdin 123#
send: FRAME and --stdin exclude each other
use one of them

send --timed
send: --timed needs --stdin
add --stdin, or drop --timed

listen --jsno
listen: unknown option '--jsno'
did you mean '--json'?

listen 08
listen: no topic '08'
did you mean '0x08' (gyroscope)?

listen gyr
listen: no topic 'gyr'
did you mean 'gyro'?

listen -n 0
listen: --count 0: not above zero
write a number above zero, such as 10

listen -n many
listen: --count many: not a whole number
write a whole number, such as 10

listen --timeout
listen: missing value for --timeout
usage: --timeout T

listen --timeout soon
listen: --timeout soon: not a time above zero
write 2s, 500ms or 1min

listen --timeout 0s
listen: --timeout 0s: not a time above zero
write 2s, 500ms or 1min

listen --json --csv
listen: --json and --csv exclude each other
use one of them

record --outptu x
record: unknown option '--outptu'
did you mean '--output'?

record gyr
record: no topic 'gyr'
did you mean 'gyro'?

record --duration 0s
record: --duration 0s: not a time above zero
write 2s, 500ms or 1min

record --bus sim,other,sim
record: --bus sim,other,sim names sim twice
name each bus once

record --split soon
record: --split soon: neither a size nor a time
write 100MB, 64MiB, 10min or 1h

record --to wav
record: no format 'wav'
one of: pcapng, pcap, mcap, mcap-raw, asc, candump, candump-ns, csv, json

replay
replay: missing FILE|-
usage: amiroctl replay FILE|- [TOPIC ...] [OPTION ...]

replay x.log --fast
replay: unknown option '--fast'
`amiroctl replay --help` lists the options

replay x.log --from-formt
replay: unknown option '--from-formt'
`amiroctl replay --help` lists the options

replay x.log gyr
replay: no topic 'gyr'
did you mean 'gyro'?

replay x.log --speed quick
replay: --speed quick: not a speed
write how many times faster, 0.000001 to 1000000, or max

replay x.log --only sensor
replay: --only sensor: unknown value
did you mean 'sensors'?

doctor --jsno
doctor: unknown option '--jsno'
did you mean '--json'?

doctor --wacth
doctor: unknown option '--wacth'
`amiroctl doctor --help` lists the options

doctor gyro
doctor: unexpected argument 'gyro'
usage: amiroctl doctor [OPTION ...]

doctor --patience soon
doctor: --patience soon: not a time above zero
write 2s, 500ms or 1min

doctor --patience
doctor: missing value for --patience
usage: --patience T

decode --topics gyro
decode: unknown option '--topics'
did you mean '--topic'?

decode --field gyro.q x.log
decode: no field 'gyro.q'
did you mean 'gyro.x'?

decode --until soon
decode: --until soon: not a time
write 500ms, 2s or 1.5s

decode --from wav
decode: no log format 'wav'
there are: pcapng, pcap, mcap, blf, asc, candump, candump-ns, candump-screen, csv, json

encode --keepgoing
encode: unknown option '--keepgoing'
did you mean '--keep-going'?

encode a b
encode: unexpected argument 'b'
usage: amiroctl encode [FILE] [OPTION ...]

encode --to wav
encode: no log format 'wav'
--to names a format: pcapng, pcap, mcap, mcap-raw, asc, candump, candump-ns, csv, json

convert
convert: missing IN
usage: amiroctl convert IN OUT [OPTION ...]

convert a
convert: missing OUT
usage: amiroctl convert IN OUT [OPTION ...]

convert a b --form x
convert: unknown option '--form'
did you mean '--from'?

convert a b c
convert: unexpected argument 'c'
usage: amiroctl convert IN OUT [OPTION ...]

convert a b --to wav
convert: no log format 'wav'
--to names a format: pcapng, pcap, mcap, mcap-raw, asc, candump, candump-ns, csv, json

top --intervall 1s
top: unknown option '--intervall'
did you mean '--interval'?

top gyr
top: no topic 'gyr'
did you mean 'gyro'?

top --interval soon
top: --interval soon: not a time
write 500ms, 2s or 1.5s

top --interval 1ms
top: --interval 1ms: twenty pictures a second are the most
write --interval 50ms, or longer

top --interval 49ms
top: --interval 49ms: twenty pictures a second are the most
write --interval 50ms, or longer

top --interval 50ms
top draws on a terminal, and standard output is none
amiroctl stats and listen write to anything

serve --adress 1
serve: unknown option '--adress'
did you mean '--address'?

serve gyr
serve: gyr is no log
name a log, or nothing for the bus

serve robts
serve: robts is no log
did you mean 'robots'?

serve a.log b.log
serve: unexpected argument 'b.log'
one log at a time

serve --port 70000
serve: --port 70000: out of range
write a number from 0 to 65535

serve --address 0.0.0.0
serve: --address 0.0.0.0 is open to other machines, and without TLS all that they see and send is open, too
give --certificate and --key, or leave --address out: ssh -L 8484:localhost:8484 ROBOT brings the page to your machine

serve --certificate x.pem
serve: --certificate without --key
give both, as PEM files

stats --asert x
stats: unknown option '--asert'
did you mean '--assert'?

stats gyr
stats: no topic 'gyr'
did you mean 'gyro'?

stats --duration 0s
stats: --duration 0s: not a time above zero
write 2s, 500ms or 1min

stats --assert gyro
stats: --assert gyro: compares nothing
write TOPIC.QUANTITY>NUMBER, such as gyro.rate>1.9 or bus.load<40%

stats --bitrate fast
stats: --bitrate fast: no bit rate of CAN
1 to 1000000 bits a second, such as 500k or 125000

plot
plot: no field to draw
name some: plot drive.log gyroscope.z; `amiroctl info gyro` lists fields

plot --titel x
plot: unknown option '--titel'
did you mean '--title'?

plot gyr
plot: no topic 'gyr'
did you mean 'gyro'?

plot gyro.z --size big
plot: --size big: no size
write WIDTHxHEIGHT in pixels, 200 to 16384 each, such as 1200x600

operate
operate: missing FILE
usage: amiroctl operate FILE [OPTION ...]

operate a --chekc
operate: unknown option '--chekc'
did you mean '--check'?

operate a b --check
operate: unexpected argument 'b'
usage: amiroctl operate FILE [OPTION ...]

operate a --check --bitrate fast
operate: --bitrate fast: no bit rate of CAN
1 to 1000000 bits a second, such as 500k or 125000

operator
operator: missing VERB
usage: amiroctl operator status|why|switch|hold|resume ...

operator statsu
operator: unknown verb 'statsu'
did you mean 'status'?

operator status --jsno
operator status: unknown option '--jsno'
did you mean '--json'?

operator switch
operator switch: missing CONFIGURATION
usage: amiroctl operator switch CONFIGURATION [OPTION ...]

run
run: missing SCRIPT|-
usage: amiroctl run SCRIPT|- [OPTION ...]

run a --spede 2
run: unknown option '--spede'
did you mean '--speed'?

run a --lisen
run: unknown option '--lisen'
`amiroctl run --help` lists the options

run a b
run: unexpected argument 'b'
usage: amiroctl run SCRIPT|- [OPTION ...]

run a --speed 0
run: --speed 0: out of range
write a number from 0.001 to 1000

run a --speed fast
run: --speed fast: not a number
write a number, such as 1.5

sim --sped 2
sim: unknown option '--sped'
did you mean '--speed'?

sim gyro
sim: unexpected argument 'gyro'
usage: amiroctl sim [OPTION ...]

sim --boards qmu
sim: --boards qmu: unknown value
did you mean 'qemu'?

sim --speed 0
sim: --speed 0: out of range
write a number from 0.001 to 1000

sim --robots 0
sim: --robots 0: out of range
write a number from 1 to 128

sim --links 129
sim: --links 129: out of range
write a number from 1 to 128

sim --bitrate 999
sim: --bitrate 999: no bit rate of a simulated bus
1000 to 1000000000 bits a second, such as 500k or 125000

sim --data-bitrate 999
sim: --data-bitrate 999: no bit rate of a simulated bus
1000 to 1000000000 bits a second, such as 500k or 125000

sim --bus-errors -1
sim: --bus-errors -1: out of range
write a number from 0 to 100000

sim --radio-loss 1.1
sim: --radio-loss 1.1: out of range
write a number from 0 to 1

sim --radio-range 0
sim: --radio-range 0: out of range
write a number from 0.01 to 10000

sim --port 65536
sim: --port 65536: out of range
write a number from 0 to 65535

plot x.log --port 65536
plot: --port 65536: out of range
write a number from 0 to 65535

map --port 65536
map: --port 65536: out of range
write a number from 0 to 65535

goto a 1 2 --baud 0
goto: --baud 0: out of range
write a number from 1 to 4000000

operate x.json --black-box-files 0
operate: --black-box-files 0: out of range
write a number from 1 to 10000

sim --bitrate 1000000001
sim: --bitrate 1000000001: no bit rate of a simulated bus
1000 to 1000000000 bits a second, such as 500k or 125000

sim --bitrate 99999999999
sim: --bitrate 99999999999: no bit rate of a simulated bus
1000 to 1000000000 bits a second, such as 500k or 125000

sim --bitrate x
sim: --bitrate x: no bit rate of a simulated bus
1000 to 1000000000 bits a second, such as 500k or 125000

central --robots x
central: unknown option '--robots'
did you mean '--robot'?

central x
central: unexpected argument 'x'
usage: amiroctl central [OPTION ...]

central --robot x
central: --robot 'x' is not NAME=PATH
as in --robot AVR=/dev/ttyUSB0

central --baud fast
central: --baud fast: not a whole number
write a whole number, such as 10

robots --jsno
robots: unknown option '--jsno'
did you mean '--json'?

robots --wacth
robots: unknown option '--wacth'
`amiroctl robots --help` lists the options

robots x
robots: unexpected argument 'x'
usage: amiroctl robots [OPTION ...]

robots --scan soon
robots: --scan soon: not a time
write 500ms, 2s or 1.5s

goto
goto: missing ROBOT
usage: amiroctl goto ROBOT ANGLE DISTANCE [OPTION ...]

goto a 1
goto: missing DISTANCE
usage: amiroctl goto ROBOT ANGLE DISTANCE [OPTION ...]

goto a 1 2 --nowait
goto: unknown option '--nowait'
did you mean '--no-wait'?

goto a 1 2 3
goto: unexpected argument '3'
usage: amiroctl goto ROBOT ANGLE DISTANCE [OPTION ...]

goto a x 2
goto: invalid ANGLE 'x'
expected a whole number of deg, -360 to 360, such as 90

goto a 1 2 --timeout soon
goto: --timeout soon: not a time above zero
write 2s, 500ms or 1min

calibrate
calibrate: missing ROBOT
usage: amiroctl calibrate ROBOT [OPTION ...]

calibrate a b
calibrate: unexpected argument 'b'
usage: amiroctl calibrate ROBOT [OPTION ...]

calibrate a --bawd 1
calibrate: unknown option '--bawd'
did you mean '--baud'?

calibrate a --baud fast
calibrate: --baud fast: not a whole number
write a whole number, such as 10

calibrate a --timeout soon
calibrate: --timeout soon: not a time above zero
write 2s, 500ms or 1min

pause
pause: missing ROBOT
usage: amiroctl pause ROBOT ... [OPTION ...]

pause a --bawd 1
pause: unknown option '--bawd'
did you mean '--baud'?

pause a --baud fast
pause: --baud fast: not a whole number
write a whole number, such as 10

unpause
unpause: missing ROBOT
usage: amiroctl unpause ROBOT ... [OPTION ...]

unpause a --bawd 1
unpause: unknown option '--bawd'
did you mean '--baud'?

unpause a --baud fast
unpause: --baud fast: not a whole number
write a whole number, such as 10

map
map: missing FILE
usage: amiroctl map FILE ... [OPTION ...]

map a.svg --watc
map: unknown option '--watc'
did you mean '--watch'?

map a.bmp
map: a.bmp: no kind of map
end it in .svg, .png, .pdf or .pgm

map a.svg --world
map: missing value for --world
usage: --world WORLD

map a.svg --resolution wide
map: --resolution wide: not a number
write a number, such as 1.5

line --to-robots
line: unknown option '--to-robots'
did you mean '--to-robot'?

line a b
line: unexpected argument 'b'
usage: amiroctl line [FILE] [OPTION ...]

line -n 0
line: --count 0: not above zero
write a number above zero, such as 10

completion
completion: missing bash|zsh|fish
usage: amiroctl completion bash|zsh|fish

completion bash --word
completion: unknown option '--word'
did you mean '--words'?

completion bash zsh
completion: unexpected argument 'zsh'
usage: amiroctl completion bash|zsh|fish

completion bsh
completion: unknown shell 'bsh'
did you mean 'bash'?

man --al x
man: unknown option '--al'
did you mean '--all'?

man run map
man: unexpected argument 'map'
usage: amiroctl man [VERB] [OPTION ...]

man rnu
man: unknown verb 'rnu'
did you mean 'run'?
"""

# Verbs that need no word. What they say alone, with no bus, no central and an empty standard input: exit code, first line
# of stderr. `sim` alone runs, see test_bus.py.
ALONE = {
    "list": (0, ""),
    "man": (0, ""),
    "stop": (1, "amiroctl: no bus: no CAN interface is up and no simulator runs"),
    "listen": (1, "amiroctl: no bus: no CAN interface is up and no simulator runs"),
    "doctor": (1, "amiroctl: no bus: no CAN interface is up and no simulator runs"),
    "record": (1, "amiroctl: no bus: no CAN interface is up and no simulator runs"),
    "stats": (1, "amiroctl: no bus: no CAN interface is up and no simulator runs"),
    "top": (2, "amiroctl: top draws on a terminal, and standard output is none"),
    "serve": (1, "amiroctl: no bus: no CAN interface is up and no simulator runs"),
    "decode": (1, "amiroctl: the standard input is empty"),
    "encode": (0, "0 frames encoded"),
    "line": (1, "no whole sentence in the standard input: it is read as what a robot said; --to-robot reads the other direction"),
    "robots": (1, "amiroctl: robots: there is no central at '{folder}/ocm/central'"),
    "central": (0, "no robots in {folder}/ocm/line yet; each `start` looks again. --robot NAME=PATH names one"),
    "sim": None,
}

BEGINNING = """amiroctl: missing VERB
          begin with a simulated robot, and try the others in another terminal:
            amiroctl sim
            amiroctl once power
            amiroctl listen
          `amiroctl --help` lists all verbs
"""


# Of what is said about a row: neither an unknown, missing or surplus word, nor options that exclude or need each other.
WRONG_VALUE = r"(?!unknown option|unexpected argument|missing |.* exclude each other|.* needs --)"


def rows():
    for block in MISUSE.strip().split("\n\n"):
        typed, what, remedy = block.split("\n")
        yield typed.split(), what, remedy


class Misuse(Case):
    def refused(self, typed, expected):
        with self.subTest(typed=" ".join(typed)):
            out, err = self.run_tool(*typed, code=2)
            self.assertEqual(out, "")
            self.assertEqual(err, expected)

    def test_messages(self):
        for typed, what, remedy in rows():
            self.refused(typed, f"amiroctl: {what}\n          {remedy}\n")

    def test_nothing_at_all(self):
        self.refused([], BEGINNING)

    def test_verbs(self):
        for typed, remedy in (("lisen", "did you mean 'listen'?"), ("lsit", "did you mean 'list'?"),
                              ("rec", "did you mean 'record'?"), ("frobnicate", "`amiroctl --help` lists the verbs")):
            said = f"amiroctl: unknown verb '{typed}'\n          {remedy}\n"
            self.refused([typed], said)
            self.refused([typed, "--help"], said)
        # An option before the verb is one of the program, whatever its value is.
        for typed in (["--bsu", "sim"], ["--bsu", "can0", "listen"], ["--bsu=sim", "listen", "--json"]):
            self.refused(typed, "amiroctl: unknown option '--bsu'\n          did you mean '--bus'?\n")
        self.refused(["--jsno", "listen"], "amiroctl: unknown option '--jsno'\n          `amiroctl --help` lists the options\n")
        self.refused(["--bus", "sim", "listen", "--bsu"], "amiroctl: listen: unknown option '--bsu'\n          did you mean '--bus'?\n")
        self.refused(["--bus"], "amiroctl: missing value for --bus\n          usage: --bus NAME\n")

    def test_verbs_that_need_no_word(self):
        for verb, expected in ALONE.items():
            if expected is None:
                continue
            with self.subTest(verb=verb):
                _, err = self.run_tool(verb, code=expected[0])
                self.assertEqual(err.split("\n")[0], expected[1].format(folder=self.folder))

    def test_every_verb_is_here(self):
        words = self.run_tool("completion", "--words", "--", "")[0].splitlines()[1:]
        table = list(rows())
        for verb in (word.split("\t")[0] for word in words):
            with self.subTest(verb=verb):
                mine = [(typed, what) for typed, what, _ in table if typed[0] == verb]
                self.assertTrue(any("unknown option" in what for _, what in mine), "no misspelt option")
                self.assertTrue(verb in ALONE or any(typed == [verb] for typed, _ in mine), "not alone")
                # A verb that takes any number of words refuses none for their number.
                usage = self.run_tool(verb, "--help")[0].split("Usage: ")[1].split("\n")[0]
                if " ..." not in usage.replace("[OPTION ...]", ""):
                    self.assertTrue(any("unexpected argument" in what for _, what in mine), "no word too many")
                self.assertTrue(any(re.match(WRONG_VALUE, what.removeprefix(verb).lstrip(": ")) for _, what in mine), "no wrong value")
                self.assertGreaterEqual(len(mine), 3)
                for _, what in mine:
                    self.assertTrue(what.startswith(verb), what)


if __name__ == "__main__":
    main(together=True)
