#!/bin/bash
# Sourced by the scripts that build: two builds in one folder at once would write the same files.

alone_in() {  # FOLDER COMMAND...
  local lock result=0
  mkdir -p "$1" && exec {lock}>>"$1/.lock" || return 1
  flock -n "$lock" || { echo "$(basename "$0"): waits for another build in $1/" >&2; flock "$lock"; }
  "${@:2}" || result=$?
  exec {lock}>&-
  return $result
}
