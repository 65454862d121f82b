#!/bin/bash
# Sourced by the scripts that build: two builds in one folder at once would write the same files.

alone_in() {  # FOLDER COMMAND...
  mkdir -p "$1" || return 1
  flock -n "$1/.lock" true || echo "$(basename "$0"): waits for another build in $1/" >&2
  flock "$1/.lock" "${@:2}"
}
