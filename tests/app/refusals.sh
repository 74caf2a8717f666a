# For the scripts beside it: BUILD and SOURCE in "$1" "$2"; a folder of its own; `refuses`, which counts.
set -uo pipefail
build=$1 source=$2
folder=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null; rm -rf "$folder"' EXIT
cd "$folder"
failures=0 expected=0
lumifield=$build/lumifield
plan=$source/tests/app/plans/small.json
scene=$source/resources/scenes/corner/scene.json
bench=("$build/lumifield-bench" --filter bell:15:2 --stage-speed 1000 --stage-acceleration 20000)

# refuses CODE TEXT COMMAND...: the exit code, a message with TEXT on stderr in one line, and no new dataset.
refuses() {
  local code=$1 text=$2
  shift 2
  expected=$((expected + 1))
  rm -rf new.lumi
  "$@" >stdout 2>stderr
  local got=$?
  if [ $got -ne "$code" ] || ! grep -qi -- "$text" stderr; then
    printf 'FAILED: exit %s instead of %s, or no "%s" in:\n' $got "$code" "$text"; sed 's/^/    /' stderr; failures=$((failures + 1))
  elif [ -e new.lumi ]; then
    echo "FAILED: '$text' left a dataset behind"; failures=$((failures + 1))
  else
    printf 'refused: %s\n' "$(grep -i -- "$text" stderr | head -1)"
  fi
}
scan() { refuses 1 "$1" "$lumifield" scan --bench "$2" --plan "${3:-$plan}" --out "${4:-new.lumi}"; }
edited() { sed "$2" "$1" >edited.json; [ "$(cat edited.json)" != "$(cat "$1")" ] || echo "edit '$2' changed nothing"; }

# The bench file of a bench that runs; its devices are gone once the command has ended.
"${bench[@]}" -- sh -c 'cp "$LUMIFIELD_BENCH" bench.json' || { echo "no bench file"; exit 1; }

verdict() { echo "$expected refusals, $failures wrong"; [ $failures -eq 0 ]; }
