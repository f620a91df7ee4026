#!/usr/bin/env bash
# enter.sh RUN SUBMISSION BOARD OUT: puts a merged run on the board, checks it, and copies the new entries to OUT. The board
# takes the run's suite when its keeper has opened the season: hthor leaderboard open COMMITMENT. Prints the entry's file.
source "$(dirname "$0")/common.sh"
[ $# = 4 ] || usage
entries=$(hthor leaderboard add "$1" --submission "$2" --board "$3")
hthor leaderboard validate --board "$3" --submissions "$(dirname "$2")"
mkdir -p "$4/entries"
while read -r path; do cp "$path" "$4/entries/"; done <<<"$entries"
head -1 <<<"$entries"
