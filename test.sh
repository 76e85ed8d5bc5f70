#!/usr/bin/env bash
# Installs what is missing, builds everything, and runs every test. Options go to ctest: ./test.sh -R pebbles
set -euo pipefail
cd "$(dirname "$0")"

docker/install.sh
configure=()
[[ ${CI:-} == true ]] && configure=(-DTESSERA_WERROR=ON)
cmake --preset release "${configure[@]}"
cmake --build --preset release
result=0
ctest --test-dir build/release --parallel 2 --output-on-failure --no-tests=error --label-exclude '^bench$' "$@" || result=$?

# A program passes though it skips a case: the summary above does not show that
log=build/release/Testing/Temporary/LastTest.log
echo "Skipped cases: $(grep -cE '^\[  SKIPPED \] .* ms\)$' "$log" || true)"
grep -oE 'NOT (TRIED|TESTED|COUNTED).*' "$log" | sort | uniq -c || true
exit "$result"
