#!/usr/bin/env bash
# place.sh FROM BOARD: puts the entries that another job made on this board: FROM/entries/*.json and nothing else. An entry
# that is there already must be the same.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
"$PYTHON" "$ROOT/scripts/leaderboard/parcel.py" place "$1" "$2"
