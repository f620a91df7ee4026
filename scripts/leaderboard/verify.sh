#!/usr/bin/env bash
# verify.sh ENTRY SUBMISSION SUITE DRAW OUT [SAMPLE]: plays a sample of an entry's trials and of its control's again, drawn
# with the word DRAW, and fresh tasks; writes what came of it to OUT/verification.json. For ENTRY a board's folder will do,
# which has one of that submission and suite. LEVEL as in smoke.sh; BY and DATE are for the record; FRESH is how many
# fresh tasks; OFFICIAL=1 says that the official workflow made the entry.
source "$(dirname "$0")/common.sh"
[ $# = 5 ] || [ $# = 6 ] || usage
entry=$1
if [ -d "$entry" ]; then
  suite=$("$PYTHON" -c 'import json, sys; print(json.load(open(sys.argv[1]))["suite_sha256"])' "$3/commitment.json")
  entry=$(grep -lF "\"submission\": \"$(basename "$2")\"" "$1"/entries/*.json | xargs grep -lF "\"sha256\": \"$suite\"")
  [ -f "$entry" ] || { echo "$1 has not one entry of $2 on $3, but: $entry" >&2; exit 1; }
fi
mkdir -p "$5"
hthor leaderboard verify "$entry" --agent "$2/agent.py" --suite "$3" --draw "$4" ${6:+--sample "$6"} \
  --out "$5/verification.json" --by "${BY:-}" --date "${DATE:-}" ${LEVEL:+--require-isolation "$LEVEL"} \
  ${FRESH:+--fresh "$FRESH"} ${OFFICIAL:+--official}
