#!/usr/bin/python3
"""Frames decoded by a DBC file into JSON lines beside python-can with canmatrix, in one run; loading a DBC file, and start-up:
compare.py DBC LOG LARGE_DBC DENSE_DBC TOOL [PEER_FRAMES]. The last two have 1,000 messages, Message_0 among them. Times are processor times of the child
processes, user and system; the best of some runs, because other programs disturb."""
import itertools
import os
import statistics
import subprocess
import sys
import tempfile
import time

DBC, LOG, LARGE, DENSE, TOOL = sys.argv[1:6]
PEER_FRAMES = int(sys.argv[6]) if len(sys.argv) > 6 else 20_000

# What a script with the field's libraries does: read with python-can, find the frame, decode with canmatrix, print.
PEER = r"""
import contextlib, io, json, sys, can
with contextlib.redirect_stdout(io.StringIO()):
    import canmatrix.formats
matrix = canmatrix.formats.loadp_flat(sys.argv[1])
frames = {(frame.arbitration_id.id, bool(frame.arbitration_id.extended)): frame for frame in matrix.frames}
for message in can.CanutilsLogReader(sys.argv[2]) if len(sys.argv) > 2 else ():
    frame = frames.get((message.arbitration_id, message.is_extended_id))
    values = {} if frame is None else {name: str(value.phys_value) for name, value in frame.decode(message.data).items()}
    print(json.dumps({"time": message.timestamp, "id": message.arbitration_id, "fields": values}))
"""


def run(command):
    """Processor time and time, in ns, of one run."""
    began = time.perf_counter_ns()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {process.returncode}")
    return (usage.ru_utime + usage.ru_stime) * 1e9, time.perf_counter_ns() - began


def frame_times(rows):
    """The best ns a frame of each row (name, command, frames, nothing to subtract or its start alone), runs in turn."""
    best = {}
    for _ in range(3):
        for name, command, frames, start in rows:
            took = run(command)[0] - (run(start)[0] if start else 0)
            best[name] = min(best.get(name, took / frames), took / frames)
    for name, _, frames, _ in rows:
        print(f"{name:<46} {frames:>8} frames {best[name]:9.0f} ns of processor a frame, {1e3 / best[name]:7.3f} M frames/s", flush=True)
    return best


def main():
    with open(LOG, "rb") as log:
        frames = sum(block.count(b"\n") for block in iter(lambda: log.read(1 << 20), b""))
    with tempfile.TemporaryDirectory(prefix="ocm-bench-") as folder:
        short = os.path.join(folder, "short.log")
        with open(LOG) as log, open(short, "w") as out:
            out.writelines(itertools.islice(log, PEER_FRAMES))
        python = ["/usr/bin/python3", "-c", PEER, DBC]
        best = frame_times([
            ("amiroctl decode --json", [TOOL, "decode", "--json", "--spec", DBC, LOG], frames, None),
            ("amiroctl decode --csv", [TOOL, "decode", "--csv", "--spec", DBC, LOG], frames, None),
            ("amiroctl decode --raw (prints no value)", [TOOL, "decode", "--raw", "--spec", DBC, LOG], frames, None),
            ("amiroctl stats", [TOOL, "stats", "--json", "--bitrate", "500k", "--spec", DBC, LOG], frames, None),
            ("amiroctl decode --json, with start", [TOOL, "decode", "--json", "--spec", DBC, short], PEER_FRAMES, None),
            ("python-can and canmatrix, without their start", [*python, short], PEER_FRAMES, python),
        ])
    ours, theirs = best["amiroctl decode --json"], best["python-can and canmatrix, without their start"]
    print(f"decode --json is {theirs / ours:.0f} times as fast as python-can and canmatrix")
    starts = {"start alone (the AMiRo's spec)": [TOOL, "info", "gyroscope"],
              "start with 300 messages": [TOOL, "info", "Message_0", "--spec", DBC],
              "start with 1000 messages, 7650 signals": [TOOL, "info", "Message_0", "--spec", LARGE],
              "start with 1000 messages, 13000 signals": [TOOL, "info", "Message_0", "--spec", DENSE]}
    taken = {name: [] for name in starts}
    for _ in range(40):
        for name, command in starts.items():
            taken[name].append(run(command))
    loads = {}
    for name, runs in taken.items():
        loads[name] = min(used for used, _ in runs) / 1e6
        print(f"{name:<46} median {statistics.median(took for _, took in runs) / 1e6:6.2f} ms, best "
              f"{min(took for _, took in runs) / 1e6:6.2f} ms, processor {loads[name]:6.2f} ms at best")
    alone, _, large, dense = loads.values()
    for path, took in ((LARGE, large), (DENSE, dense)):
        print(f"loading 1000 messages of {os.path.getsize(path) // 1024} KiB takes {took - alone:.2f} ms of processor")


main()
