#!/usr/bin/env bash
# nightly.sh [PART...]: the checks that take longer than those of every commit, all or some.
#   tests        the tests marked nightly, and the laws with other and three times as many cases
#   redteam      hostile agents at every level of isolation
#   fuzz         random calls of a world, random actions among loose things, damaged files and made-up command lines
#   determinism  the same run twice, byte for byte, with other numbers of jobs
#   resume       a run that is killed again and again
#   composer     trials through dm_control's composer, byte for byte those of the batch
#   bare         the tests without bubblewrap, a browser and Node: they skip with a reason, or do without
#   ray          the engine for clusters
#   calibration  a small fit of the human proxies to the published study
#   readme       every command of the documentation's first page
#   leaderboard  a submission's whole way to the board's page
source "$(dirname "$0")/leaderboard/common.sh"
cd "$ROOT"
PARTS=(tests redteam fuzz determinism resume composer bare ray calibration readme leaderboard)
JOBS=${JOBS:-$(nproc)}

part() {
  local folder
  folder=$(mktemp -d)
  case "$1" in
    tests)
      "$PYTHON" -m pytest -q -n "$JOBS" -m nightly
      HYPOTHESIS_PROFILE=explore "$PYTHON" -m pytest -q -n "$JOBS" -m hypothesis
      ;;
    redteam) "$PYTHON" -m benchmarks.redteam ;;
    fuzz)
      "$PYTHON" -m benchmarks.worldfuzz --calls 5000
      "$PYTHON" -m benchmarks.loose_things --actions 5000
      "$PYTHON" -m benchmarks.damage --files 300 --lines 60
      ;;
    determinism)
      for jobs in 1 3; do hthor eval --agent frontier --no-control --quiet --jobs "$jobs" --out "$folder/$jobs"; done
      for jobs in 1 3; do sort "$folder/$jobs/trials.jsonl" | sha256sum; done | uniq | tee "$folder/hashes"
      [ "$(wc -l <"$folder/hashes")" = 1 ]
      ;;
    resume) "$PYTHON" -m benchmarks.chaos ;;
    composer) "$PYTHON" -m benchmarks.composer_trials --trials 20 ;;
    bare)
      scripts/bare_path.sh "$folder"
      PATH="$folder" "$PYTHON" -m pytest -q -n "$JOBS" -m outside
      ;;
    ray)
      # 260 MB for one engine: it is no part of the development environment, where its tests skip
      "$PYTHON" -m pip install --quiet --disable-pip-version-check -c constraints.txt --target "$folder" 'ray>=2.40'
      PYTHONPATH="$folder" "$PYTHON" -m pytest -q tests/eval/runs/test_eval_ray.py
      ;;
    calibration) hthor calibrate --target paper --suite paper --quick --out "$folder/quick" ;;
    readme) "$PYTHON" scripts/readme.py --page docs/index.md ;;
    leaderboard) scripts/leaderboard.sh ;;
    *)
      echo "there is no part '$1': ${PARTS[*]}" >&2
      return 2
      ;;
  esac
  rm -rf "$folder"
}

[ $# -gt 0 ] || set -- "${PARTS[@]}"
for name; do
  echo
  echo "== $name"
  begin=$SECONDS
  part "$name"
  echo "== $name took $((SECONDS - begin)) s"
done
