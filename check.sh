#!/usr/bin/env bash
# Installs what is missing, builds with both compilers and with sanitizers, and runs all tests.
#   ./check.sh            everything
#   ./check.sh --quick    one build, without the slow labels
#   ./check.sh --fuzz 60  each fuzzer for 60 minutes, two at a time; failures are left in build-fuzz/tests/fuzz/found/
#   ./check.sh --peers    no tests, but a table of stiction beside dynamics engines (tests/peers/README.md)
#   ./check.sh --coverage counts which lines and branches of src/ and drivers/ the tests run, and lists the others
set -euo pipefail
cd "$(dirname "$0")"
. .ci/packages.sh

configure_and_build() { # preset
  cmake --preset "$1" >"build-$1.log" 2>&1 || { cat "build-$1.log"; return 1; }
  if grep -q 'not used by the project' "build-$1.log"; then cat "build-$1.log"; return 1; fi
  grep '^-- stiction ' "build-$1.log"
  cmake --build --preset "$1" >>"build-$1.log" 2>&1 || { tail -n 60 "build-$1.log"; return 1; }
}

if [ "${1:-}" = --peers ]; then
  need build ninja
  offer peers
  [ -x build-peers/venv/bin/pip ] || python3 -m venv build-peers/venv || true
  # shellcheck disable=SC2046 # a list of names
  build-peers/venv/bin/pip install -q --no-deps --only-binary :all: $(sed -n 's/^peers-pypi: //p' packages) ||
    echo "no MuJoCo from PyPI: it is left out"
  configure_and_build peers
  exec build-peers/stiction_peers --csv build-peers/peers.csv
fi

need build run video devices view test check

if [ "${1:-}" = --fuzz ]; then
  cmake --preset ci -B build-fuzz -DSTICTION_FUZZ_SECONDS=$((60 * ${2:-10})) >/dev/null
  cmake --build build-fuzz
  exec ctest --test-dir build-fuzz -L fuzz -j "$(nproc)" --output-on-failure
fi

if [ "${1:-}" = --quick ]; then
  configure_and_build ci
  exec ctest --preset ci -LE 'slow|kernel|fuzz|lint|valgrind|install' -j "$(nproc)"
fi

# Builds, runs the tests but those of some labels, and counts. Of our own objects alone: those of tests compile parts of
# them once more. Guests of the kernel tests bring no counts back.
coverage() { # labels to leave out
  configure_and_build coverage
  find build-coverage -name '*.gcda' -delete # counts of earlier builds
  local failed=0
  ctest --preset coverage -LE "slow|kernel|fuzz$1" -j "$(nproc)" || failed=$?
  echo "Lines and branches that no test runs; tests/coverage.md says why:"
  gcovr --root . build-coverage --exclude-directories '.*/tests/.*' --filter src/ --filter drivers/ \
    --print-summary --fail-under-line 95 || failed=$?
  return "$failed"
}

if [ "${1:-}" = --coverage ]; then
  coverage ""
  exit
fi

configure_and_build ci-clang
configure_and_build asan
configure_and_build tsan
ctest --preset tsan -L live -j "$(nproc)"
ctest --preset asan -L 'unit|invariants|files|cli|driver' -LE 'slow' -j "$(nproc)"
coverage '|oracle|determinism|invariants|lint|valgrind|install' # what they run, others run too, and sooner
configure_and_build ci
ctest --preset ci -j "$(nproc)"
