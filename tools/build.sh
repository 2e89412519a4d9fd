# shellcheck shell=bash
# Shared by ./raio, ./check and tools/wheels: installs missing packages, builds a preset. Sourced by bash; needs
# $root, the folder of the project. Messages go to stderr, so stdout has only results.
: "${root:?}"

say() { printf '%s: %s\n' "${0##*/}" "$*" >&2; }
fail() {
  say "$@"
  exit 3
}

# packages SECTION...: the packages in these sections of packages.txt.
packages() {
  local line wanted=
  while read -r line; do
    line=${line%%#*}
    line=${line//[[:space:]]/}
    case $line in
      '') ;;
      '['*) [[ " $* " == *" ${line:1:-1} "* ]] && wanted=yes || wanted= ;;
      *) [[ $wanted ]] && printf '%s\n' "$line" ;;
    esac
  done <"$root/packages.txt"
  return 0
}

# show_log_and_fail LOG MESSAGE: the end of the log, and its path.
show_log_and_fail() {
  tail -n 30 "$1" >&2
  fail "$2; the whole log: $1"
}

# install_packages SECTION...: installs the packages that are missing according to Debian.
install_packages() {
  local -a wanted missing as_root=() command=(apt-get install -y --no-install-recommends)
  mapfile -t wanted < <(packages "$@")
  if type dpkg-query >/dev/null 2>&1; then
    mapfile -t missing < <(comm -23 <(printf '%s\n' "${wanted[@]}" | LC_ALL=C sort) \
      <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${wanted[@]}" 2>/dev/null |
        sed -n 's/^installed //p' | LC_ALL=C sort -u))
    ((${#missing[@]})) || return 0
  else
    missing=("${wanted[@]}")
  fi

  ((EUID == 0)) || as_root=(sudo)
  if ! type dpkg-query apt-get "${as_root[@]}" >/dev/null 2>&1; then
    say "these packages (by their Debian names) are missing: ${missing[*]}"
    fail "install them, on Debian as root with: ${command[*]} ${missing[*]}"
  fi
  say "installing ${#missing[@]} Debian packages: ${missing[*]}"
  local log=$root/build/packages.log
  as_root+=(env DEBIAN_FRONTEND=noninteractive)
  command=("${as_root[@]}" "${command[@]}" -o DPkg::Lock::Timeout=600 "${missing[@]}")
  # The lists of packages are fetched only when they are absent or too old to install from.
  "${command[@]}" >"$log" 2>&1 </dev/null && return 0
  {
    "${as_root[@]}" apt-get update && "${command[@]}"
  } >>"$log" 2>&1 </dev/null ||
    show_log_and_fail "$log" "could not install the packages: ${missing[*]}"
}

# show_progress LOG: copies stdin to the log and, on a terminal, its last "[done/all]" to one line.
show_progress() {
  local line
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$1"
    if [[ -t 2 && $line =~ ^\[[0-9]+/[0-9]+\] ]]; then printf '\r  %s ' "${BASH_REMATCH[0]}" >&2; fi
  done
  if [[ -t 2 ]]; then printf '\r%20s\r' '' >&2; fi
}

# is_configured PRESET: whether its folder is ready to build; that of a checkout that was moved is not.
is_configured() {
  [[ -e $root/build/$1/build.ninja ]] &&
    grep -qsxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$root/build/$1/CMakeCache.txt"
}

# build PRESET [TARGET...]: configures the preset, with $cmake_options, and builds it. The file `built`
# in its folder has the start time of the last successful build.
build() {
  local preset=$1 folder=$root/build/$1 log=$root/build/$1.log target targets=()
  shift
  for target in "$@"; do targets+=(--target "$target"); done
  local -a configure=(cmake --preset "$preset" "${cmake_options[@]}")
  is_configured "$preset" || configure+=(--fresh)
  mkdir -p "$folder"
  touch "$folder/starting"
  say "building ($preset; log: $log)"
  {
    cd "$root"
    "${configure[@]}" && cmake --build --preset "$preset" "${targets[@]}"
  } 2>&1 </dev/null | { : >"$log"; show_progress "$log"; } ||
    show_log_and_fail "$log" "the build failed"
  mv "$folder/starting" "$folder/built"
}

# lock: one installation or build at a time in this checkout; unlock lets the next one in.
lock() {
  if ! { mkdir -p "$root/build" && exec 9>"$root/build/lock"; } 2>/dev/null; then
    fail "cannot write to $root/build"
  fi
  flock -n 9 && return 0
  say "waiting for another build to end"
  flock 9
}
unlock() { exec 9>&-; }
