#!/usr/bin/env bash
# watch.sh BOARD SUBMISSIONS: for each entry of a board a page that shows a trial in 3-D, BOARD/watch/ID/index.html, which the
# board's page links when it is built again. All agents play the same trial of the public suite 'smoke', so that they can be
# compared. An entry whose agent is neither hthor's own nor in SUBMISSIONS, or that cannot be played, has no page.
# LEVEL as in smoke.sh.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Each entry's id and agent, a line each.
agents() {
  "$PYTHON" - "$2" "$1"/entries/*.json <<'PY'
import json
import pathlib
import sys

for path in sys.argv[2:]:
    entry = json.loads(pathlib.Path(path).read_bytes())
    own, submission = entry["reference"], entry["submission"]
    print(entry["id"], entry["agent"]["name"] if own else submission and f"{sys.argv[1]}/{submission}/agent.py", sep="|")
PY
}

agents "$1" "$2" | while IFS='|' read -r id agent; do
  files=()
  [ ! -f "$agent" ] || files=(--agent "$agent")
  if [ -n "$agent" ] &&
    hthor eval --agent "$agent" --suite smoke --house birch --limit 1 --no-control --quiet \
      ${LEVEL:+--require-isolation "$LEVEL"} --out "$work/$id" </dev/null >/dev/null &&
    hthor watch "$work/$id" 0 "${files[@]}" --out "$1/watch/$id" </dev/null; then continue; fi
  echo "$id: no page" >&2
done
