#!/usr/bin/env bash
# Takes the screenshots for README.md and docs/view.md, on a separate display.
# Needs ./raio built, and Debian's xvfb, xdotool and imagemagick.
#   tools/window_pictures.sh
set -euo pipefail
cd "${BASH_SOURCE[0]%/*}/.."
pictures=$PWD/docs/pictures
frames=$(mktemp -d)
export DISPLAY=:88 LIBGL_ALWAYS_SOFTWARE=1 LC_ALL=C.UTF-8 XDG_STATE_HOME=$frames
Xvfb "$DISPLAY" -screen 0 1280x900x24 -nolisten tcp >"$frames/display.log" 2>&1 &
trap 'kill %1; rm -rf "$frames"' EXIT
sleep 1

# open SECONDS ARGUMENT...: opens the window and waits this long.
open() {
  local seconds=$1
  shift
  rm -rf "$frames/raio"  # what the window remembers
  "${RAIO-./raio}" view "$@" 2>"$frames/view.log" &
  sleep "$seconds"
  window=$(xdotool search --onlyvisible --name . | tail -1)
}
keys() { for key; do xdotool key "$key"; done; }
shoot() { import -window "$window" -depth 8 -strip "$@"; }
# The picture of 480x320 between the bars above and below.
shoot_picture() {
  shoot png:- | convert - -gravity north -chop 0x42 -gravity south -chop 0x29 \
    -gravity center -crop 480x320+0+0 +repage "$1"
}
close() {
  keys q
  wait %%
}

open 5 scenes/shapes.nff --accel grid
keys i
xdotool mousemove 505 480 click 1
sleep 1
xdotool mousemove 831 142 sleep 0.5 click 1 sleep 1 mousemove 977 527 sleep 0.5 click 1 mousemove 600 700
sleep 8
shoot "$pictures/view-ray.png"
close

lights=(--soft-shadows --light-size 5000)
open 4 scenes/shapes.nff "${lights[@]}" --dof --aperture 0.06
sleep 12
shoot "$pictures/view.png"
close

open 8 scenes/droplet.dump --color-by c_pe
xdotool mousemove 380 380 click 1
sleep 3
shoot "$pictures/view-figure.png"
close

open 2 scenes/shapes.nff --size 480x320 "${lights[@]}" --dof --aperture 0.06
keys h d d x
sleep 5
shoot_picture "$pictures/view-split.png"
close

open 2 scenes/sphereflake.nff --size 480x320 --accel grid --grid-factor 2
keys h 6
sleep 3
shoot_picture "$pictures/view-steps.png"
close

open 2 scenes/sphereflake.nff --size 480x320 --accel grid
keys h k
sleep 5
shoot_picture "$pictures/view-boxes.png"
close

open 5 scenes/sphereflake.nff --accel grid
keys n
sleep 60
xdotool mousemove 930 600 click --repeat 40 5 mousemove 300 755
sleep 1
shoot "$pictures/view-curve.png"
close

open 3 scenes/shapes.nff "${lights[@]}"
xdotool mousemove 400 372 mousedown 1
for i in {1..20}; do
  xdotool mousemove $((400 + (i > 10 ? 20 - i : i) * 14)) $((372 - i))
  sleep 0.1
  shoot "$(printf '%s/turn%02d.png' "$frames" "$i")"
done
xdotool mouseup 1
sleep 1.5
shoot "$frames/still1.png"
for key in d x; do
  keys "$key"
  sleep 3
  shoot "$frames/still2$key.png"
done
keys x
for key in 6 g; do
  keys "$key"
  sleep 2
  shoot "$frames/still3$key.png"
done
close
convert -delay 14 "$frames"/turn*.png -delay 130 "$frames"/still*.png -resize 600x +dither -colors 96 -loop 0 \
  -layers optimize "$pictures/view.gif"
