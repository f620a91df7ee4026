#!/usr/bin/env bash
# smoke.sh SUBMISSION OUT [PEOPLE]: plays an agent on the public suite 'smoke' and fails when it does.
# LEVEL=L3 in the environment demands that isolation; without it the strongest that there is will do.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || [ $# = 3 ] || usage
hthor eval --agent "$1/agent.py" --suite smoke --no-control --quiet --participants "${3:-6}" \
  ${LEVEL:+--require-isolation "$LEVEL"} --out "$2"
