#!/usr/bin/env bash
# build.sh [BOARD]: makes the list and the page anew from the entries.
source "$(dirname "$0")/common.sh"
[ $# -le 1 ] || usage
hthor leaderboard build --board "${1:-$ROOT/leaderboard}"
