#!/usr/bin/env bash
# Installs into a prefix, builds consumers against it by CMake and by pkg-config, shared and static, runs them;
# then moves the prefix and does it again.
#   prefix.sh BUILD WORK LIBDIR        environment: CC, CMAKE
set -euo pipefail
build=$1 work=$2 lib=$3
here=$(cd "$(dirname "$0")" && pwd)
scene=$here/../../traces/two-vertex/scene.yaml
trace=$here/../../traces/two-vertex/hand.csv

expect_consumer() { # PROGRAM
  [ "$("$1" "$scene")" = "$version 2 surfaces" ] || { echo "$1: not '$version 2 surfaces'" >&2; exit 1; }
}

by_cmake() { # PREFIX TARGET [COMPONENT]
  local into=$work/cmake
  rm -rf "$into"
  "$CMAKE" -S "$here/consumer" -B "$into" -DCMAKE_C_COMPILER="$CC" -DCMAKE_PREFIX_PATH="$1" -DTARGET="$2" \
    -DCOMPONENT="${3:-}" >"$work/log"
  "$CMAKE" --build "$into" >>"$work/log"
  expect_consumer "$into/consumer"
}

by_pkg_config() { # PREFIX
  local flags
  export PKG_CONFIG_PATH=$1/$lib/pkgconfig PKG_CONFIG_LIBDIR=/nowhere # nothing else's .pc file is needed
  flags=$(pkg-config --cflags --libs stiction)
  # shellcheck disable=SC2086 # flags are words
  "$CC" "$here/consumer/consumer.c" $flags -Wl,-rpath,"$1/$lib" -o "$work/shared"
  expect_consumer "$work/shared"
  flags=$(pkg-config --static --cflags --libs stiction | sed 's/-lstiction\b/-l:libstiction.a/')
  # shellcheck disable=SC2086
  "$CC" "$here/consumer/consumer.c" $flags -o "$work/static"
  expect_consumer "$work/static"
  unset PKG_CONFIG_PATH PKG_CONFIG_LIBDIR
}

try() { # PREFIX
  echo "in $1"
  version=$("$1/bin/stiction" --version | sed -n 's/^stiction //p')
  by_cmake "$1" stiction
  by_cmake "$1" static static
  by_pkg_config "$1"
  if [ -f "$1/$lib/stiction/stiction-video.so" ]; then # the program finds it beside itself
    "$1/bin/stiction" replay "$scene" "$work/short.csv" --size 160x120 --quality fast --video "$work/short.mp4"
  fi
}

rm -rf "$work"
mkdir -p "$work"
head -n 12 "$trace" >"$work/short.csv"
"$CMAKE" --install "$build" --prefix "$work/first" >"$work/log"
for file in include/stiction.h share/man/man1/stiction.1.gz lib/udev/rules.d/70-stiction.rules; do
  [ -f "$work/first/$file" ] || { echo "not installed: $file" >&2; exit 1; }
done
if grep -rlI "$work\|$build" "$work/first"; then
  echo "the files above name the folder that they were built or installed in" >&2
  exit 1
fi
try "$work/first"
mv "$work/first" "$work/moved"
try "$work/moved"
# Without its modules the program still runs, under its own licence alone.
rm -rf "$work/moved/$lib/stiction"
"$work/moved/bin/stiction" --version >"$work/version"
printf 'stiction %s\nMIT licence\nvideo: none\nwindow: none\n' "$version" | diff - "$work/version"

example=$work/moved/share/doc/libstiction-dev/examples
"$CMAKE" -S "$example" -B "$work/example" -DCMAKE_C_COMPILER="$CC" -DCMAKE_PREFIX_PATH="$work/moved" >"$work/log"
"$CMAKE" --build "$work/example" >>"$work/log"
"$work/example/own_loop" 40 >"$work/loop.txt"
grep -q 'edge .* slips' "$work/loop.txt" || { tail -n 5 "$work/loop.txt" >&2; exit 1; }
