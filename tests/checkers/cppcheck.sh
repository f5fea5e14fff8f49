#!/bin/sh
# cppcheck over all that we wrote.   cppcheck.sh SOURCE BUILD      environment: TOOL
exec "$TOOL" --project="$2/compile_commands.json" -i "$1/tests" -i "$1/traces" -i "$2" -q --error-exitcode=1 \
  --enable=warning,style,performance,portability --inline-suppr \
  --suppressions-list="$(dirname "$0")/cppcheck.txt" --template='{file}:{line}: {message} [{id}]'
