#!/usr/bin/env bash
# Installs what is missing, builds, and replays the traces of traces/ into out/.
set -euo pipefail
cd "$(dirname "$0")"
. .ci/packages.sh

need build run video devices view
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
show=two-vertex
build/stiction replay "traces/$show/scene.yaml" "traces/$show/hand.csv" --frames "out/$show/frames" \
  --video "out/$show/video.mp4" --report "out/$show/report.html" --timing "out/$show/timing.json"
build/stiction still "traces/$show/scene.yaml" "traces/$show/hand.csv" --sheet --out "out/$show/sheet.png"
build/stiction plot "out/$show/log.csv" --scene "traces/$show/scene.yaml" --out "out/$show/plots" >/dev/null

cat <<END

What was made, for every trace of traces/ (its README says what happens there):
  out/*/log.csv            one row per tracker sample: pose, forces, contacts, slips (columns: README.md)
  out/*/events.csv         every touch, slip, opening and snap
  out/*/timing.json        what a frame cost, against the 31 Hz of the tracker
and for the box that leans on floor and wall:
  out/$show/report.html    open this in a browser: the video beside its plots, frame by frame
  out/$show/video.mp4
  out/$show/frames/        its pictures, 31 a second
  out/$show/sheet.png      the interesting moments on one page
  out/$show/plots/         figures 11 and 12 of the paper, as SVG, PDF and PNG
END
