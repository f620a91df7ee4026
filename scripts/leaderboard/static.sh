#!/usr/bin/env bash
# static.sh SUBMISSION: looks at a submission without running anything of it.
source "$(dirname "$0")/common.sh"
[ $# = 1 ] || usage
hthor leaderboard check "$1"
