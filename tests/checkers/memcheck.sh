#!/usr/bin/env bash
# valgrind on the program: every recorded trace, both levels; and the ways in and out.
#   memcheck.sh PROGRAM TRACES WORK      environment: TOOL
set -euo pipefail
program=$1 traces=$2 work=$3
log=$work/memcheck.csv

check() { # EXPECTED_CODE ARGUMENTS...
  local expected=$1 code=0
  shift
  "$TOOL" -q --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite "$program" "$@" \
    >"$work/memcheck.out" 2>"$work/memcheck.err" || code=$?
  if [ "$code" != "$expected" ]; then
    echo "$*: ended with $code, not $expected"
    cat "$work/memcheck.err"
    exit 1
  fi
}

for scene in "$traces"/*/scene.yaml; do
  trace=$(dirname "$scene")/hand.csv
  [ -f "$trace" ] || continue
  head -n 400 "$trace" >"$work/memcheck-hand.csv"
  for how in "event f64" "frame f32"; do
    check 0 replay "$scene" "$work/memcheck-hand.csv" --accuracy "${how% *}" --precision "${how#* }" \
      --log "$log" --events "$work/memcheck-events.csv" --timing "$work/memcheck.json"
  done
done
check 0 run "$scene" --device "trace:file=$work/memcheck-hand.csv,speed=50" --log "$log" --record "$work/memcheck-rec.csv"
check 0 check "$scene" "$work/memcheck-hand.csv"
check 0 explain "$scene" "$work/memcheck-hand.csv"
check 1 check "$work/memcheck-hand.csv"
check 3 replay "$scene" "$scene" --log "$log"
check 2 replay "$scene"
rm -f "$work"/memcheck*.csv "$work/memcheck.json"
