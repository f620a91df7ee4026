#!/usr/bin/env bash
# leaderboard.sh [SUBMISSION]: the whole way from a submission to the page, on a small salted suite, by the scripts that the
# workflows call. Works in a folder of its own, on a copy of leaderboard/. Without a submission it hands in the template.
source "$(dirname "$0")/leaderboard/common.sh"
STEPS=$ROOT/scripts/leaderboard
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

step() {
  echo
  echo "-- $*"
  local begin=$SECONDS
  "$STEPS/$1" "${@:2}"
  echo "-- took $((SECONDS - begin)) s"
}

refused() {
  # A step that must fail, with a word that it must say.
  local told=$1
  shift
  echo
  echo "-- to be refused: $*"
  if "$STEPS/$1" "${@:2}" >said 2>&1; then
    cat said
    echo "it was not refused" >&2
    exit 1
  fi
  grep -m3 -- "$told" said
}

mkdir -p submissions
if [ $# = 1 ]; then cp -r "$1" submissions/; else
  mkdir submissions/template
  hthor agent new submissions/template/agent.py >/dev/null
  echo '{"name": "Template", "version": "1", "licence": "Apache-2.0"}' >submissions/template/submission.json
fi
mine=$(echo submissions/*)
cp -r "$ROOT/leaderboard" board

step static.sh "$mine"
step smoke.sh "$mine" smoke 1
sha256sum <<<"no secret: the same small suite every time" | cut -c1-64 | "$STEPS/salt.sh" salt
step suite.sh small salt suite 2 20
(cd "$ROOT" && hthor leaderboard open "$work/suite/commitment.json" --board "$work/board") # the keeper opens a season
step plan.sh 2
step control.sh suite runs/control
for shard in 1 2; do step shard.sh "$mine" suite "$shard/2" runs/mine; done
step seal.sh salt sealed runs/mine-shard-1-of-2 runs/mine-shard-2-of-2
rm -r runs/mine-shard-*
step unseal.sh salt shard sealed
step merge.sh runs/mine runs/mine-shard-1-of-2 runs/mine-shard-2-of-2
step enter.sh runs/mine "$mine" board entered | tee said
entry=$(grep -o 'board/entries/[^ ]*\.json' said | head -1)
draw=$(sha256sum "$entry" | cut -c1-40) # on GitHub, the commit that merged the submission
FRESH=10 OFFICIAL=1 step verify.sh "$entry" "$mine" suite "$draw" verified 16
step record.sh verified board
step validate.sh board
cp -r "$ROOT/leaderboard" published # as another machine has it, which ran nothing of the submission
cp -r board/suites board/admission.json published/
step place.sh entered published
step record.sh verified published

cp -r board tampered
sed -i 's/"successes": [0-9]*/"successes": 0/' "tampered/entries/$(basename "$entry")"
refused counts.successes validate.sh tampered
cp "$entry" "tampered/entries/"
(cd "$ROOT" && "$PYTHON" -m benchmarks.forging "$work/$entry" "$work/tampered/entries/$(basename "$entry")" --share 0.5 \
  --suite "$work/suite")
FRESH=0 refused REFUTED verify.sh "tampered/entries/$(basename "$entry")" "$mine" suite "$draw" refuted 20
mkdir -p forged/entries
cp "tampered/entries/$(basename "$entry")" forged/entries/
refused 'is not written over' place.sh forged published

step build.sh board
DRY_RUN=1 step pull_request.sh "$(basename "$mine")"
grep -q 'V1' board/index.html
echo
echo "the page: $(wc -c <board/index.html) bytes, $(grep -c '<tr' board/index.html) rows; $SECONDS s in all"
