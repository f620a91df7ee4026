#!/usr/bin/env bash
# baselines.sh [FOLDER [BOARD]]: plays the references on 'standard' and puts them on the board, in the place of those that
# are there: no robot, nearest, frontier, savn (which needs the extra torch), oracle. A folder with the runs is finished, or
# only read. Each is verified by SAMPLE (200) drawn trials and tried on FRESH (200) fresh tasks.
source "$(dirname "$0")/leaderboard/common.sh"
folder=${1:-$ROOT/runs/baselines} board=${2:-$ROOT/leaderboard}
hthor eval --agent none --agent nearest --agent frontier --agent savn --agent oracle --suite standard --quiet --out "$folder"
PYTHONPATH="$ROOT" "$PYTHON" "$ROOT/scripts/leaderboard/stale.py" "$board"
hthor leaderboard open --board "$board"
hthor leaderboard add "$folder" --board "$board"
for entry in "$board"/entries/*-standard-*.json; do
  case "$(basename "$entry")" in none-* | nearest-* | frontier-* | savn-* | oracle-*) ;; *) continue ;; esac
  hthor leaderboard verify "$entry" --draw "$(git -C "$ROOT" rev-parse HEAD)" --sample "${SAMPLE:-200}" \
    --fresh "${FRESH:-200}" --by baselines.sh --write --board "$board"
done
hthor leaderboard build --board "$board"
