#!/usr/bin/env bash
# savn.sh [SEEDS [FOLDER]]: trains the networks that ship with hthor from nothing, and compares them with controls.
#
#   benchmarks/savn.sh                            seed 0, which ships, into training/shipped
#   benchmarks/savn.sh "0 1 2 3 4" training/five  five seeds, with bc beside them
#
# Pose grids come first, then for each seed a network without adaptation (base), and from it both savn and a2c. Two
# trainings run at a time, each on one core. Called again, it goes on where it was. FOLDER/eval.json is the comparison.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
seeds=${1:-0}
folder=${2:-training/shipped}
make --silent -C "$root" torch
export PATH=$root/.venv/bin:$PATH folder

# ALGORITHM NAME SEED OPTION...
train() {
  local algorithm=$1 name=$2 seed=$3
  shift 3
  hthor train "$algorithm" --out "$folder/$name-$seed" --seed "$seed" --device cpu "$@" >"$folder/$name-$seed.log" 2>&1 ||
    { tail -n 5 "$folder/$name-$seed.log" >&2; return 1; }
  echo "$name-$seed: $(tail -n 1 "$folder/$name-$seed/metrics.jsonl")"
}
second() { # ALGORITHM SEED
  train "$1" "$1" "$2" --begin "$folder/base-$2" --frames 1M --every 250k \
    --set learning_rate=0.0005 --set wrong=-2 --set horizon=80 --set close=0.25
}
export -f train second

# Runs each line of its input as a command, two at a time.
two_at_a_time() { xargs -P 2 -I{} bash -c '{}'; }

mkdir -p "$folder"
echo "-- pose grids"
hthor train a2c --out "$folder/grids" --frames 1 --batch 1 --device cpu >/dev/null
rm -r "$folder/grids"
echo "-- first networks"
for seed in $seeds; do echo "train a2c base $seed --frames 10M"; done | two_at_a_time
echo "-- savn and a2c"
for seed in $seeds; do printf 'second savn %s\nsecond a2c %s\n' "$seed" "$seed"; done | two_at_a_time
checkpoints=()
for name in savn a2c; do for seed in $seeds; do checkpoints+=("$folder/$name-$seed"); done; done
if [[ $seeds == *" "* ]]; then
  echo "-- bc"
  for seed in $seeds; do echo "train bc bc $seed --frames 5M"; done | two_at_a_time
  for seed in $seeds; do checkpoints+=("$folder/bc-$seed"); done
fi
echo "-- comparison"
hthor train eval "${checkpoints[@]}" --out "$folder/eval.json"
