#!/usr/bin/env bash
# lock.sh: makes requirements.txt anew, with the hash of every file that pip may install for the official evaluation. Takes
# uv, which is not one of hthor's dependencies.
source "$(dirname "$0")/common.sh"
[ $# = 0 ] || usage
out=$ROOT/scripts/leaderboard/requirements.txt
head=$(sed -n '/^#/p' "$out")
cd "$ROOT"
uv pip compile pyproject.toml - -c constraints.txt --python-version 3.12 --python-platform x86_64-manylinux_2_28 \
  --generate-hashes --no-emit-index-url --no-header --no-annotate --quiet -o "$out.new" <<<"setuptools>=77"
{ echo "$head"; cat "$out.new"; } >"$out"
rm "$out.new"
