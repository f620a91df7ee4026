#!/usr/bin/env bash
# merge.sh OUT SHARD...: joins the shards of a run; fails when something is missing, and says what.
source "$(dirname "$0")/common.sh"
[ $# -ge 2 ] || usage
out=$1
shift
code=0
hthor merge "$@" --out "$out" || code=$?
[ $code = 0 ] || [ $code = 3 ] || exit $code
