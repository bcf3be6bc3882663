# Sourced by the scripts beside it: packages, quiet steps, build trees.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
logs=build/logs
mkdir -p "$logs"
started=$SECONDS

# clang takes four fifths of the time of g++ 12 here, and what it makes runs as much faster (scripts/README.md). Both will do.
export CXX=${CXX:-clang++-14}

build_packages="ca-certificates g++ clang-14 cmake ninja-build ccache libeigen3-dev libsimbody-dev libtomlplusplus-dev libfast-float-dev
  nlohmann-json3-dev libcli11-dev libboost-math-dev libfftw3-dev libtbb-dev libmatio-dev zlib1g-dev libhdf5-dev libssl-dev libjs-dygraphs libjs-three python3"
test_packages="xz-utils catch2 clang-format-14 clang-tidy-14 libclang-rt-14-dev
  chromium chromium-driver python3-selenium poppler-utils help2man snakemake python3-h5py python3-jsonschema
  python3-sphinx python3-myst-parser furo python3-matplotlib
  pybind11-dev python3-dev python3-pytest python3-numpy python3-pandas python3-xarray python3-scipy
  mypy python3-nbclient python3-ipykernel octave"

# Many sources at once, which saves Eigen from being read and compiled anew for each; for work on single files leave it out.
joined="-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=8"

# step NAME COMMAND …: one line when it passes; what failed and the end of its output when it fails.
step() {
  local name=$1 log=$logs/${1//[^A-Za-z0-9]/_}.log from=$SECONDS
  shift
  if "$@" >"$log" 2>&1; then
    printf '%-28s ok  %4d s\n' "$name" $((SECONDS - from))
  else
    printf '%-28s FAILED after %d s; %s says:\n' "$name" $((SECONDS - from)) "$log"
    grep -E '(error|Error|FAILED|\*\*\*Failed|warning:)' "$log" | head -n 20 || true
    tail -n 30 "$log"
    exit 1
  fi
}

# install PACKAGE …: installs what is missing, and nothing else.
install() {
  local missing=()
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" = "install ok installed" ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  "${as_root[@]}" apt-get update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

# build PRESET [OPTION…] [-- TARGET…]: configures build/PRESET and builds the targets (all without any).
build() {
  local preset=$1 options=() targets=()
  shift
  while [ $# -gt 0 ] && [ "$1" != -- ]; do options+=("$1"); shift; done
  [ $# -gt 0 ] && shift
  for target in "$@"; do targets+=(--target "$target"); done
  cmake --preset "$preset" "${options[@]}" && cmake --build "build/$preset" "${targets[@]}"
}

sources() { git ls-files 'models/*.[ch]pp' 'plugin/*.[ch]pp' 'identify/*.[ch]pp' 'tests/*.[ch]pp'; }
formatting() { sources | xargs clang-format-14 --dry-run --Werror; }

# An hour for a test: it ends what hangs, and nothing that a loaded machine slows down. One more at a time than there are
# cores, since a browser, a terminal and a killed command are waited for.
run_tests() { ctest --test-dir "build/$1" --output-on-failure --no-tests=error --timeout 3600 -j "$(($(nproc) + 1))"; }

# clang-tidy on the eight sources that changed last, without its path analyser, as in check_deep.
tidy_changed() {
  cmake --preset release -B build/tidy -DCMAKE_CXX_COMPILER=clang++-14 -DWEMS_BUILD_TESTS=OFF -DCMAKE_UNITY_BUILD=OFF \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
  local changed
  changed=$(git log --no-merges --name-only --format= -n 100 -- 'models/*.cpp' 'identify/*.cpp' 'plugin/*.cpp' ':!*/python/*' |
    awk '!seen[$0]++' | while read -r name; do if [ -e "$name" ]; then echo "$name"; fi; done | sed -n 1,8p)
  [ -n "$changed" ] || return 0
  python3 scripts/tidy.py build/tidy "$(tr '\n' '|' <<<"$changed" | sed 's/|$//; s/\./[.]/g; s/^/\/(/; s/$/)$/')" -checks='-clang-analyzer-*'
}
