#!/usr/bin/python3
"""Frames decoded from a candump log into JSON lines, and back, beside what others need for the same log, in one run:
compare.py LOG TOOL [PEER_FRAMES]. Times are processor times of the child processes, user and system."""
import os
import re
import subprocess
import sys
import tempfile
import time

LOG, TOOL = sys.argv[1:3]
PEER_FRAMES = int(sys.argv[3]) if len(sys.argv) > 3 else 100_000

# What a script with the field's libraries does: read with python-can, look the frame up in a matrix, decode, print.
# The frames' layouts are those of the spec, given to canmatrix as a DBC with one message a frame.
PEER = r"""
import json, sys, can, canmatrix.formats
matrix = next(iter(canmatrix.formats.loadp(sys.argv[1]).values()))
frames = {frame.arbitration_id.id: frame for frame in matrix.frames}
for message in can.CanutilsLogReader(sys.argv[2]):
    frame = frames.get(message.arbitration_id)
    values = {} if frame is None else {name: str(value.phys_value) for name, value in frame.decode(message.data).items()}
    print(json.dumps({"time": message.timestamp, "id": message.arbitration_id, "fields": values}))
"""
READ = "import sys, can\nfor message in can.CanutilsLogReader(sys.argv[1]): pass\n"
SIGNALS = {0x602: 32, 0x603: 32, 0x604: 16, 0x605: 32, 0x606: 32, 0x607: 32, 0x608: 16, 0x609: 16, 0x61E: 16,
           **{0x61F + i: 16 for i in range(8)}}
LENGTHS = {0x602: 8, 0x603: 8, 0x604: 8, 0x605: 4, 0x606: 4, 0x607: 4, 0x608: 6, 0x609: 6, 0x61E: 6,
           **{0x61F + i: 2 for i in range(8)}}


def run(name, command, frames, **files):
    began = time.perf_counter()
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL, **files)
    peak = 0  # of its own memory: what wait4 says includes this program's
    while True:
        with open(f"/proc/{process.pid}/status") as status:
            peak = max([peak, *map(int, re.findall(r"VmHWM:\s*(\d+)", status.read()))])
        done, status, usage = os.wait4(process.pid, os.WNOHANG)
        if done:
            break
        time.sleep(0.005)
    wall = time.perf_counter() - began
    cpu = usage.ru_utime + usage.ru_stime
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{name}: exit code {process.returncode}")
    print(f"{name:<34} {frames:>9} frames {cpu * 1e9 / frames:9.0f} ns of processor a frame "
          f"{frames / cpu / 1e6:7.3f} M frames/s, wall {wall:6.2f} s, {peak / 1024:5.1f} MiB", flush=True)
    return cpu / frames


def main():
    with tempfile.TemporaryDirectory(prefix="ocm-bench-") as folder:
        with open(LOG, "rb") as log:
            frames = sum(block.count(b"\n") for block in iter(lambda: log.read(1 << 20), b""))
        short = os.path.join(folder, "short.log")
        with open(LOG) as log, open(short, "w") as out:
            for _, line in zip(range(PEER_FRAMES), log):
                out.write(line)
        dbc = os.path.join(folder, "frames.dbc")
        with open(dbc, "w") as out:
            for number, width in SIGNALS.items():
                out.write(f"BO_ {number} F{number:X}: {LENGTHS[number]} V\n")
                for i in range(8 * LENGTHS[number] // width):
                    out.write(f' SG_ s{i} : {i * width}|{width}@1- (0.0175,0) [0|0] "" V\n')
                out.write("\n")
        lines = os.path.join(folder, "short.jsonl")
        null = {"stdout": subprocess.DEVNULL}
        ours = run("amiroctl decode --json", [TOOL, "decode", "--json", LOG], frames, **null)
        run("amiroctl decode --csv", [TOOL, "decode", "--csv", LOG], frames, **null)
        run("amiroctl decode --pretty", [TOOL, "decode", "--pretty", LOG], frames, **null)
        with open(lines, "w") as out:
            run("amiroctl decode --json to a file", [TOOL, "decode", "--json", short], PEER_FRAMES, stdout=out)
        run("amiroctl encode", [TOOL, "encode", lines], PEER_FRAMES, **null)
        with open(LOG) as log:
            other = run("log2long (decodes nothing)", ["log2long"], frames, stdin=log, **null)
        print(f"decode --json takes {ours / other:.2f} of the time of log2long")
        other = run("python-can reads only", ["/usr/bin/python3", "-c", READ, short], PEER_FRAMES, **null)
        print(f"decode --json is {other / ours:.0f} times as fast")
        other = run("python-can and canmatrix decode", ["/usr/bin/python3", "-c", PEER, dbc, short], PEER_FRAMES, **null)
        print(f"decode --json is {other / ours:.0f} times as fast")


main()
