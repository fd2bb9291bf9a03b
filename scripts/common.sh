# Read by the other scripts: goes to the root of the repository and defines how a preset is built.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# As many jobs as there are cores, but one for each 1.5 GB of memory: translation units with OpenCASCADE's headers and
# sanitizers are large.
jobs() {
  local cores memory_kb by_memory
  cores=$(nproc 2>/dev/null || echo 2)
  memory_kb=$(awk '/^MemAvailable/ {print $2}' /proc/meminfo 2>/dev/null || echo 4000000)
  by_memory=$((memory_kb / 1500000))
  if [ "$by_memory" -lt 1 ]; then by_memory=1; fi
  echo $((cores < by_memory ? cores : by_memory))
}

# build PRESET [TARGET…]: configures if need be and builds.
build() {
  local preset=$1
  shift
  # What two presets compile alike is compiled once.
  if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER-ccache} CCACHE_BASEDIR=${CCACHE_BASEDIR-$PWD} CCACHE_NOHASHDIR=1
  fi
  if [ ! -f "build/$preset/build.ninja" ]; then cmake --preset "$preset"; fi
  local targets=()
  if [ $# -gt 0 ]; then targets=(--target "$@"); fi
  cmake --build "build/$preset" -j "$(jobs)" "${targets[@]}"
}

# run_tests PRESET [OPTION…]: runs the suite of a built preset, the options being ctest's, and prints how many cases and
# checks there were.
run_tests() {
  local preset=$1 result=0
  shift
  ctest --test-dir "build/$preset" --output-on-failure -j 2 "$@" || result=$?
  print_test_summary "$preset"
  return "$result"
}

# print_test_summary PRESET: one line about the last run of its suite.
print_test_summary() {
  grep -h '^\[doctest\] \(test cases\|assertions\)' "build/$1/Testing/Temporary/LastTest.log" |
    awk -v preset="$1" '/test cases/ {cases += $4; failed += $9} /assertions/ {checks += $3}
      END {printf "%s: %d test cases, %d failed, %d checks\n", preset, cases, failed, checks}'
}
