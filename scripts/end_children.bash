#!/bin/bash
# Sourced by the scripts that compile, test or fuzz: a script that is ended early ends what it has started. Ctrl-C reaches
# all processes of a terminal; `kill`, an editor or a service manager reaches the script alone, and its compilers would
# go on for minutes.

descendants() {  # PROCESS: parents first
  local child
  for child in $(pgrep -P "$1"); do echo "$child"; descendants "$child"; done
}
end_children() {
  local found
  mapfile -t found < <(descendants $$)
  [ ${#found[@]} = 0 ] || kill "${found[@]}" 2>/dev/null || true  # some have ended: those that listed them
}
trap end_children EXIT  # also before the end by a signal, at once: a trap of the signal itself would wait for the compilers
