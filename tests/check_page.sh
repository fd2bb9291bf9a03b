#!/usr/bin/env bash
# Opens a report of `tri compare` in a browser without a display and checks that nothing is logged as an error, that the part is
# drawn, turns and is zoomed, and that tables and pins answer.
#
#   check_page.sh CHROMIUM TRI
set -euo pipefail

chromium=$1
tri=$2
leaks=$(realpath "$(dirname "$0")/leaks.supp")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# OpenCASCADE's readers keep what they parsed of a file, which the leak sanitizer, where the program is built with it, reports.
export LSAN_OPTIONS=print_suppressions=0:suppressions=$leaks

"$tri" model bracket -o part.step >/dev/null
"$tri" sample --cad part.step -n 2000 --noise 0.05 --no-truth -o points.xyz -q >/dev/null
"$tri" triangulate --cad part.step points.xyz -o mesh.ply -q >/dev/null

# Before everything else: what goes wrong is kept, and frames come by a timer, since time in this browser is virtual and runs
# ahead of real frames.
before='<script>
window.wrong = [];
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), 16);
window.addEventListener("error", (event) => wrong.push(event.message));
for (const kind of ["error", "warn"]) console[kind] = function () { wrong.push(Array.from(arguments).join(" ")); };
</script>'
# After everything else: looks at the canvas, presses what can be pressed, and leaves the findings in the document.
after='<script>
(function () {
  const frame = () => new Promise((done) => setTimeout(done, 200));
  function picture() {
    const canvas = document.querySelector("#canvas canvas");
    if (!canvas) return { colors: 0, drawn: 0, sum: 0 };
    const copy = document.createElement("canvas");
    copy.width = canvas.width;
    copy.height = canvas.height;
    const context = copy.getContext("2d");
    context.drawImage(canvas, 0, 0);
    const bytes = context.getImageData(0, 0, copy.width, copy.height).data, colors = new Set();
    let drawn = 0, sum = 0;
    for (let i = 0; i < bytes.length; i += 4) {
      if (bytes[i + 3] === 0) continue;
      ++drawn;
      colors.add((bytes[i] << 16) | (bytes[i + 1] << 8) | bytes[i + 2]);
      sum = (sum * 31 + bytes[i] + 3 * bytes[i + 1] + 7 * bytes[i + 2] + i) % 1000000007;
    }
    return { colors: colors.size, drawn: drawn / (copy.width * copy.height), sum: sum };
  }
  function require(truth, what) {
    if (!truth) wrong.push("not so: " + what);
  }
  const button = (text) => Array.from(document.querySelectorAll("#views button")).find((b) => b.textContent === text);
  (async function () {
    await frame();
    const start = picture();
    require(start.colors > 300, "the canvas is not blank, it has " + start.colors + " colours");
    require(start.drawn > 0.05 && start.drawn < 0.9, "the part fills a part of the canvas: " + start.drawn);
    button("+Z").click();
    await frame();
    const above = picture();
    require(above.sum !== start.sum, "a button turns the part");
    document.querySelector("#canvas canvas").dispatchEvent(new WheelEvent("wheel", { deltaY: -300, clientX: 300, clientY: 300 }));
    await frame();
    require(picture().sum !== above.sum, "the wheel zooms");
    document.querySelector("tr[data-face]").click();
    await frame();
    require(document.querySelector("tr[data-face].chosen"), "a face can be chosen");
    document.querySelector("tr[data-spot]").click();
    await frame();
    const probe = document.getElementById("probe");
    require(!probe.hidden && /mm/.test(probe.textContent), "a worst place says its deviation");
    require(document.querySelectorAll("#pins button").length === document.querySelectorAll("tr[data-spot]").length, "every worst place has a pin");
    const head = Array.from(document.querySelectorAll(".sortable th")).find((th) => th.textContent === "max");
    head.click();
    const column = head.cellIndex;
    const numbers = Array.from(document.querySelector(".sortable").tBodies[0].rows).map((row) => parseFloat(row.cells[column].textContent));
    const known = numbers.filter((n) => !isNaN(n));
    require(known.length > 3 && known.every((n, i) => i === 0 || known[i - 1] >= n), "a click on a head sorts");
    document.documentElement.setAttribute("data-findings", wrong.length ? wrong.join(" | ") : "all well");
  })();
})();
</script>'

check() {
  local page=$1
  BEFORE=$before AFTER=$after awk '{ print } /<head>/ { print ENVIRON["BEFORE"] }
    END { print ENVIRON["AFTER"] }' "$page" >checked.html
  timeout -s KILL 120 "$chromium" --headless=new --no-sandbox --disable-dev-shm-usage --user-data-dir="$folder/profile" \
    --use-angle=swiftshader --enable-unsafe-swiftshader --window-size=1400,1000 --virtual-time-budget=20000 \
    --dump-dom "file://$folder/checked.html" >dom.html 2>log.txt || { cat log.txt >&2; exit 1; }
  local findings
  findings=$(grep -o 'data-findings="[^"]*"' dom.html | head -1 || true)
  echo "$page: ${findings:-the page did not run to its end}"
  [ "$findings" = 'data-findings="all well"' ]
}

"$tri" compare --cad part.step mesh.ply --tolerance -0.1,0.1 --report mesh.html -q >/dev/null
"$tri" compare --cad part.step points.xyz --report points.html -q >/dev/null
check mesh.html
check points.html
