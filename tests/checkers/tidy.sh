#!/bin/sh
# clang-tidy over all that we wrote.   tidy.sh SOURCE BUILD JOBS      environment: TOOL
exec "$TOOL" -p "$2" -j "$3" -quiet "^$1/(src|drivers|render)/"
