#!/usr/bin/env bash
# shard.sh SUBMISSION SUITE I/N OUT: plays one share of a submission's run, in OUT-shard-I-of-N.
# An agent that fails in some trials is scored all the same. LEVEL as in smoke.sh.
source "$(dirname "$0")/common.sh"
[ $# = 4 ] || usage
code=0
hthor eval --agent "$1/agent.py" --suite "$2" --shard "$3" --quiet ${LEVEL:+--require-isolation "$LEVEL"} --out "$4" || code=$?
[ $code = 0 ] || [ $code = 3 ] || exit $code
