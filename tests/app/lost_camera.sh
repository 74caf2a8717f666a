# For the scripts beside it that lose a camera in mid-scan. They set `folder` and `fail`, and exported: `scan` (up to
# its dataset's name), `knob` of $folder/knobs, and `times`.

# disturb FRAMES OFF_S: a scan whose camera is turn by turn off and on, frozen and let go, $times times, each after FRAMES
# new frames and for OFF_S.
disturb() {
  $scan disturbed.lumi 2>disturbed &
  local scanner=$! fault=camera_off
  for ((n = 0; n < times; ++n)); do
    local seen=$($knob "get frames")
    until [ "$($knob "get frames")" -gt $((seen + $1)) ] || ! kill -0 $scanner 2>/dev/null; do sleep 0.02; done
    $knob "$fault 1" >>turned && sleep "$2" && $knob "$fault 0" >>turned
    [ $fault = camera_off ] && fault=frozen_camera || fault=camera_off
  done
  wait $scanner
}
export -f disturb

# survives_losses REFERENCE FRAMES OFF_S BENCH...: such a scan ends complete, with the cells of REFERENCE.lumi.
survives_losses() {
  local reference=$1 frames=$2 off_s=$3
  shift 3
  "$@" --knobs "$folder/knobs" -- bash -c "disturb $frames $off_s" || fail "the disturbed scan: $(cat disturbed)"
  [ "$(grep -c "is waited for up to 60 s" disturbed)" -eq "$(grep -c "is back after" disturbed)" ] || fail "said otherwise: $(cat disturbed)"
  [ "$(grep -c "is back after" disturbed)" -ge "$times" ] || fail "the camera was not lost $times times: $(cat disturbed)"
  diff -r "$reference.lumi/cells" disturbed.lumi/cells || fail "the cells differ after the camera was lost"
  tr '\r' '\n' <disturbed | grep "is back after"
}
