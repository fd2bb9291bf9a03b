#!/usr/bin/env bash
# A session at the editor's window, with real keys and a real mouse on a display without a screen; checks what it says and
# what it saves.
#
#   check_editor.sh TRI_EDITOR TRI [SCREENSHOT.png]
set -euo pipefail

editor=$(realpath "$1")
tri=$(realpath "$2")
screenshot=${3:+$(realpath -m "$3")}
folder=$(mktemp -d)
cd "$folder"

display=
cleanup() {
  kill "${editor_process-}" "${display_process-}" 2>/dev/null || true
  rm -rf "$folder"
}
trap cleanup EXIT
failed() {
  echo "check_editor: $1" >&2
  cat said >&2
  exit 1
}

# A display of our own: the server chooses a free number and says it.
exec 3<> <(:)
mkfifo number
Xvfb -displayfd 4 -screen 0 1280x800x24 4>number 2>/dev/null &
display_process=$!
read -r display <number
export DISPLAY=:$display LIBGL_ALWAYS_SOFTWARE=1

# wait_for PATTERN: until the editor has said a further line that fits; prints it.
seen=0
wait_for() {
  local line
  for _ in $(seq 300); do
    line=$(tail -n "+$((seen + 1))" said | grep -n -m 1 -E "$1" || true)
    if [ -n "$line" ]; then
      seen=$((seen + ${line%%:*}))
      echo "${line#*:}" | tee -a session
      return
    fi
    if ! kill -0 "$editor_process" 2>/dev/null; then failed "the editor has ended while '$1' was awaited"; fi
    sleep 0.1
  done
  failed "the editor did not say '$1'"
}
# Held for as long as a person would: the text fields see only keys that are down when a frame is drawn.
key() {
  xdotool keydown ${1//+/ keydown }
  sleep 0.2
  xdotool keyup ${1//+/ keyup }
}
drag() {  # from x y to x y
  xdotool mousemove "$1" "$2"
  sleep 0.2
  xdotool mousedown 1
  sleep 0.2
  xdotool mousemove "$3" "$4"
  sleep 0.2
  xdotool mouseup 1
}
run() {
  key ctrl+f
  sleep 0.3
  xdotool type --delay 30 "$1"
  sleep 0.3
  key Return
}

# A cylinder wall with a hole in its side and open ends: 3 loops.
python3 - <<'END'
import math
around, along = 60, 20
points = [(math.cos(2 * math.pi * i / around) * 10, math.sin(2 * math.pi * i / around) * 10, j) for j in range(along + 1) for i in range(around)]
faces = []
for j in range(along):
    for i in range(around):
        if 8 <= j < 12 and 3 <= i < 9:
            continue
        a, b = j * around + i, j * around + (i + 1) % around
        faces += [(a, b, b + around), (a, b + around, a + around)]
with open("wall.off", "w") as f:
    print("OFF", file=f)
    print(len(points), len(faces), 0, file=f)
    for p in points: print(*p, file=f)
    for t in faces: print(3, *t, file=f)
END

touch said session
"$editor" wall.off >said 2>&1 &
editor_process=$!
wait_for '^opened wall.off: 1260 vertices, 2352 faces'
window=$(xdotool search --sync --name 'tri editor' | head -1)
xdotool windowfocus "$window"
sleep 0.5

key ctrl+a
wait_for '^selected: 2352 faces'
key ctrl+d
wait_for '^selected: 0 faces'

# A box around the part, then what hangs together with it: all. Then a smaller box for what follows.
drag 400 250 520 400
part=$(wait_for '^selected: [1-9][0-9]* faces')
key ctrl+l
wait_for '^selected: 2352 faces'
drag 400 250 520 400
wait_for "^$part"

# An operator on the selection, taken back and done again.
run subdivide
changed=$(wait_for '^subdivide: .*faces added')
key ctrl+z
wait_for '^undone: subdivide'
if [ -n "$screenshot" ]; then
  key ctrl+y
  sleep 1
  import -window root "$screenshot"
  key ctrl+z
  wait_for '^undone: subdivide'
fi
key ctrl+y
wait_for '^redone: subdivide'
key ctrl+z
wait_for '^undone: subdivide'

# On the whole mesh: holes, all three.
key ctrl+d
wait_for '^selected: 0 faces'
run fill-holes
wait_for '^fill-holes: .*faces added'
key ctrl+shift+s
sleep 0.5
key ctrl+a
xdotool type --delay 20 "$folder/closed.off"
key Return
wait_for '^saved .*closed.off'

# A wrong path is said, and the mesh is still there.
key ctrl+o
sleep 0.5
key ctrl+a
xdotool type --delay 20 "$folder/nothing.stl"
key Return
wait_for '^open .*nothing.stl failed: '
key ctrl+q
wait "$editor_process" || failed "the editor ended with an error"

"$tri" check closed.off --json >check.json || true
python3 - <<'END'
import json
check = json.load(open("check.json"))
text = json.dumps(check)
assert '"watertight": true' in text, text
END
lines=$(sed -n 2p closed.off)
test "${lines%% *}" = 1260 || failed "vertices were lost: $lines"
echo "check_editor: all well; $part, $changed"
