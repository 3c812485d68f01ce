#!/bin/sh
# SPDX-License-Identifier: MIT
# Installs the programs of this archive, or removes them. It prints each file that it writes or removes.
#   ./install.sh [PREFIX]              below PREFIX: by default /usr/local, which needs root (sudo)
#   ./install.sh --uninstall [PREFIX]  removes what it has installed there
# The udev rules give the logged-in user access to the port of a lidar, and keep ModemManager and brltty away from it. They
# work below /usr and /usr/local only. A lidar that is plugged in already gets them, too.
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)

uninstall=
if [ "${1:-}" = --uninstall ]; then
  uninstall=yes
  shift
fi
prefix=${1:-/usr/local}
case $prefix in
  /*) ;;
  *)
    sed -n '/^#   /s/^#   //p' "$0" >&2
    echo "PREFIX begins with /" >&2
    exit 2
    ;;
esac
list=$prefix/share/g4lidar/installed-files

apply_rules() {
  if [ "$(id -u)" = 0 ] && [ -S /run/udev/control ] && command -v udevadm >/dev/null; then
    echo "udevadm control --reload; udevadm trigger"
    udevadm control --reload && udevadm trigger --subsystem-match=tty --subsystem-match=usb || true
  fi
}

# make_directory <directory>: those that did not exist are in the list, with a slash at the end.
make_directory() {
  if [ ! -d "$1" ]; then
    make_directory "$(dirname "$1")"
    mkdir "$1"
    echo "$1/" >>"$new"
  fi
}

# Also before an installation: an older one may have files that this one has not.
remove() {
  grep -v '/$' "$list" | while IFS= read -r file; do
    echo "remove $file"
    rm -f "$file"
  done
  made=$(grep '/$' "$list" | sort -r)
  rm -f "$list"
  echo "$made" | while IFS= read -r directory; do rmdir "$directory" 2>/dev/null || true; done
}

if [ "$uninstall" ] && [ ! -e "$list" ]; then
  echo "Nothing is installed below $prefix ($list does not exist)" >&2
  exit 1
fi
new=$(mktemp)
# However it ends, the list has what was written, so that --uninstall removes it.
trap 'if [ -s "$new" ] && [ -d "$prefix/share/g4lidar" ]; then cp "$new" "$list"; fi; rm -f "$new"' EXIT
trap 'exit 130' INT TERM HUP
if ! make_directory "$prefix" 2>/dev/null || [ ! -w "$prefix" ]; then
  echo "No permission to write to $prefix: use sudo, or another PREFIX, such as $HOME/.local" >&2
  exit 1
fi
if [ -e "$list" ]; then remove; fi
if [ "$uninstall" ]; then
  apply_rules
  exit 0
fi

make_directory "$prefix/share/g4lidar"
rules=yes
case $prefix in /usr | /usr/local) ;; *) rules= ;; esac
(cd "$here" && find bin share lib licenses -type f | sort) | while IFS= read -r file; do
  target=$prefix/$file
  case $file in
    lib/udev/*) if [ ! "$rules" ]; then continue; fi ;;
    licenses/*) target=$prefix/share/doc/g4lidar/$file ;;
  esac
  echo "install $target"
  make_directory "$(dirname "$target")"
  cp "$here/$file" "$target.new"
  chmod "$(case $file in bin/*) echo 755 ;; *) echo 644 ;; esac)" "$target.new"
  mv "$target.new" "$target" # a program that runs keeps its old file
  echo "$target" >>"$new"
done
if [ "$rules" ]; then
  apply_rules
else
  echo "Without the udev rules, which work below /usr and /usr/local only. To install them:"
  echo "  sudo cp '$here'/lib/udev/rules.d/*.rules /etc/udev/rules.d/ && sudo udevadm control --reload && sudo udevadm trigger"
fi
case :$PATH: in *:"$prefix/bin":*) ;; *) echo "$prefix/bin is not in PATH: add it" ;; esac
