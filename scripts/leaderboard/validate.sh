#!/usr/bin/env bash
# validate.sh [BOARD]: every entry in order, and the list and the page as the entries make them.
source "$(dirname "$0")/common.sh"
[ $# -le 1 ] || usage
hthor leaderboard validate --board "${1:-$ROOT/leaderboard}"
hthor leaderboard build --check --board "${1:-$ROOT/leaderboard}"
