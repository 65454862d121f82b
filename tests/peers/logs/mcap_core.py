"""Foxglove's @mcap/core, which scripts/setup fetches, as a function."""

import glob
import json
import os
import subprocess

CACHE = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
TREES = sorted(glob.glob(os.path.join(CACHE, "ocm", "mcap-*", "node_modules")))
PROGRAM = os.path.join(os.path.dirname(os.path.abspath(__file__)), "mcap_peer.mjs")


def run(verb, path, stdin=None):
    """What mcap_peer.mjs prints for `verb` ("indexed", "streamed", "write") and the file."""
    if not TREES:
        raise AssertionError(f"no @mcap/core in {CACHE}/ocm: run scripts/setup")
    done = subprocess.run(["node", PROGRAM, os.path.dirname(TREES[-1]), verb, path], capture_output=True, text=True,
                          input=stdin, timeout=60, check=False)
    if done.returncode != 0:
        raise AssertionError(f"@mcap/core on {path}: {done.stderr}")
    return json.loads(done.stdout) if done.stdout else None
