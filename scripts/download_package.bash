#!/bin/bash
# Sourced by the scripts that take files out of a Debian package without installing it, and what it depends on.

download_package() (  # NAME FOLDER: its .deb into the folder; where it cannot be had, 1, and on stderr what apt-get says
  cd "$2" || exit 1
  apt-get -qq download "$1" >apt.log 2>&1 && exit
  # With root, for new lists of packages: those that are here may not know it.
  [ "$(id -u)" != 0 ] || apt-get -qq -o DPkg::Lock::Timeout=300 update >>apt.log 2>&1 || true
  apt-get -qq download "$1" >>apt.log 2>&1 && exit
  cat apt.log >&2
  exit 1
)
