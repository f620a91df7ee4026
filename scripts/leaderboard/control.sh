#!/usr/bin/env bash
# control.sh SUITE OUT: plays the suite without a robot, which every agent is measured against.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
hthor eval --agent none --suite "$1" --quiet --out "$2"
