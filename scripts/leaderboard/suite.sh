#!/usr/bin/env bash
# suite.sh NAME SALT_FILE OUT [HOUSES TASKS]: makes the official suite of a salt.
source "$(dirname "$0")/common.sh"
[ $# = 3 ] || [ $# = 5 ] || usage
hthor suite make "$1" --salt-file "$2" --out "$3" --houses "${4:-40}" --tasks "${5:-2000}"
