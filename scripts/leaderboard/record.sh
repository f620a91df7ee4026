#!/usr/bin/env bash
# record.sh FROM BOARD: takes the verification that another job made, FROM/verification.json and nothing else, and puts it
# beside the entry that it is of. It fails when it is of another entry, or of this one as it was not handed in.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
"$PYTHON" "$ROOT/scripts/leaderboard/parcel.py" only "$1" verification.json
hthor leaderboard record "$1/verification.json" --board "$2"
