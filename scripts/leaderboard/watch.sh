#!/usr/bin/env bash
# watch.sh BOARD SUBMISSIONS: for each entry of a board a page that shows a trial in 3-D, which the board's page links when it is
# built again. All agents play the same trial of the public suite 'smoke', so that they can be compared. An entry whose agent is neither built in
# nor in SUBMISSIONS, or that cannot be played, has no page. LEVEL as in smoke.sh.
source "$(dirname "$0")/common.sh"
[ $# = 2 ] || usage
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The entry's id, its agent's name and its submission, a line each.
entries() {
  "$PYTHON" - "$1"/entries/*.json <<'PY'
import json
import pathlib
import sys

for path in sys.argv[1:]:
    entry = json.loads(pathlib.Path(path).read_bytes())
    print(entry["id"], entry["agent"]["name"] if not entry["submission"] else "", entry["submission"], sep="|")
PY
}

entries "$1" | while IFS='|' read -r id name submission; do
  agent=${submission:+$2/$submission/agent.py} own=()
  [ -z "$agent" ] || own=(--agent "$agent")
  if hthor eval --agent "${agent:-$name}" --suite smoke --house birch --limit 1 --no-control --quiet \
    ${LEVEL:+--require-isolation "$LEVEL"} --out "$work/$id" </dev/null >/dev/null &&
    hthor watch "$work/$id" 0 "${own[@]}" --out "$1/watch/$id" </dev/null; then continue; fi
  echo "$id: no page" >&2
done
