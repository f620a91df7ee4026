#!/usr/bin/env bash
# enter.sh RUN SUBMISSION SUITE BOARD: puts a merged run on the board, with the commitment to its suite, and checks it.
# Prints the entry's file.
source "$(dirname "$0")/common.sh"
[ $# = 4 ] || usage
mkdir -p "$4/suites"
name=$("$PYTHON" -c 'import json, sys; print(json.load(open(sys.argv[1]))["name"])' "$3/commitment.json")
cp "$3/commitment.json" "$4/suites/$name.json"
entries=$(hthor leaderboard add "$1" --submission "$2" --board "$4")
hthor leaderboard validate --board "$4" --submissions "$(dirname "$2")"
head -1 <<<"$entries"
