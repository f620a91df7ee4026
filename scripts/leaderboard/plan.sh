#!/usr/bin/env bash
# plan.sh N: the numbers of N shards, as JSON for a matrix.
source "$(dirname "$0")/common.sh"
[ $# = 1 ] || usage
shards="[$(seq -s, 1 "$1")]"
echo "$shards"
[ -z "${GITHUB_OUTPUT:-}" ] || echo "shards=$shards" >>"$GITHUB_OUTPUT"
