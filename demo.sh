#!/usr/bin/env bash
# Installs what is missing, builds, and replays the traces of traces/ into out/.
set -euo pipefail
cd "$(dirname "$0")"
. .ci/packages.sh

need build run video devices
[ -f build/CMakeCache.txt ] || cmake -S . -B build -DSTICTION_TESTS=OFF >/dev/null
cmake --build build --target stiction_program -j "$(nproc)" | tail -n 1

rm -rf out
mkdir -p out
for scene in traces/*/scene.yaml; do
  trace=$(dirname "$scene")
  name=$(basename "$trace")
  [ -f "$trace/hand.csv" ] || continue # slow-hour is generated on request
  mkdir -p "out/$name"
  build/stiction replay "$scene" "$trace/hand.csv" --log "out/$name/log.csv" --events "out/$name/events.csv" \
    --timing "out/$name/timing.json"
  printf '%-22s %6d frames, %4d slips\n' "$name" "$(grep -vc '^[#t]' "out/$name/log.csv")" \
    "$(tail -n 1 "out/$name/log.csv" | cut -d, -f14)"
done
build/stiction replay traces/single-vertex/scene.yaml traces/single-vertex/hand.csv --frames out/single-vertex/frames

cat <<'END'

What was made:
  out/*/log.csv               one row per tracker sample: pose, forces, contacts, slips (columns: README.md)
  out/*/events.csv            every touch, slip, opening and snap
  out/*/timing.json           what a frame cost, against the 31 Hz of the tracker
  out/single-vertex/frames/   pictures of the stick-slip trace, 31 a second
END
