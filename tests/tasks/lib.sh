# What the scripts of this folder have in common: `step` runs the command and says how many seconds it took.
merlkit=${MERLKIT:-merlkit}

if (($# != 2)); then
  echo "usage: $0 FOLDER_OF_MERL_BINARIES FOLDER_TO_WRITE" >&2
  exit 2
fi
brdfs=$1
out=$2
mkdir -p "$out"

# Runs the words after the first, which say what was done.
timed() {
  local what=$1 start=$EPOCHREALTIME
  shift
  "$@"
  local seconds
  seconds=$(awk -v from="$start" -v to="$EPOCHREALTIME" 'BEGIN { printf "%.1f", to - from }')
  printf '%6s s  %s\n' "$seconds" "$what"
}

step() {
  timed "merlkit $*" "$merlkit" "$@"
}
