#!/usr/bin/env bash
# nightly.sh PART: what takes too long for every commit. redteam: hostile agents at every level. determinism: the same
# run twice, byte for byte, with other numbers of jobs. resume: a run that is killed again and again.
source "$(dirname "$0")/leaderboard/common.sh"
cd "$ROOT"
case "${1:-}" in
  redteam) "$PYTHON" -m pytest -q tests/guest/confinement/test_redteam.py tests/guest/confinement/test_confinement.py ;;
  resume) "$PYTHON" -m benchmarks.chaos ;;
  determinism)
    folder=$(mktemp -d)
    for jobs in 1 3; do hthor eval --agent frontier --no-control --quiet --jobs "$jobs" --out "$folder/$jobs"; done
    for jobs in 1 3; do sort "$folder/$jobs/trials.jsonl" | sha256sum; done | uniq | tee "$folder/hashes"
    [ "$(wc -l <"$folder/hashes")" = 1 ]
    ;;
  *) usage ;;
esac
