#!/bin/sh
# precompile.sh COMPILER ...: compiles, without the precompiled header that it makes. Where that one is there from before, ccache
# takes it for what it is made of, whatever has changed since, and gives what once came after it.
before=
for word; do
  [ "$before" != -o ] || case $word in *.gch) rm -f -- "$word" ;; esac
  before=$word
done
exec "$@"
