#!/usr/bin/env bash
# Installs what is missing, builds in release and runs the demo: two soft bodies pushed apart.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/demo.sh [a.obj b.obj]

Without arguments: the two tori of the paper, started with 40 % of their vertices inside one another.
With two closed surfaces in Wavefront files: those, scaled to one size and started deeply overlapped.
Writes ParaView files and a picture of start and end under out/.
Exit status: 0 when the bodies came apart, 1 when not or when something failed, 2 for a wrong command line.
END
}

case "${1:-}" in
    -h | --help) usage && exit 0 ;;
    -*) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac
(($# == 0 || $# == 2)) || { usage >&2 && fail "give no file or two, not $#" 2; }
files=()
for file in "$@"; do
    path="$(absolute_path "$file")"
    [[ -r "$path" && -f "$path" ]] || fail "cannot read '$file': give the path of a Wavefront .obj file"
    files+=("$path")
done

scripts/setup.sh
say 'Building (release)'
cmake --workflow --preset release >&2 || fail 'the build failed, see above'

demo=build/release/demos/two_bodies
[[ -x "$demo" ]] || fail "the build made no $demo"
started="$(mktemp)"
trap 'rm -f "$started"' EXIT
status=0
"$demo" ${files[@]+"${files[@]}"} || status=$?

# On standard error, so that the demo's own last line stays the last line of the output.
while IFS= read -r picture; do
    say "Picture: $root/$picture"
done < <(find out -name '*.png' -newer "$started" 2>/dev/null)
exit "$status"
