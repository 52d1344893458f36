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

scripts/setup.sh demo
say 'Building the library and the demo (release)'
{ cmake --preset demos && cmake --build --preset demos --target two_bodies; } >&2 || fail 'the build failed, see above'

demo=build/demos/demos/two_bodies
[[ -x "$demo" ]] || fail "the build made no $demo: see its messages above"

# Kept back until the picture is drawn, so that the demo's last line is the last line.
answer="$(mktemp)"
trap 'rm -f "$answer"' EXIT
status=0
rm -f out/two_bodies.pvd out/two_bodies.png
"$demo" --out out ${files[@]+"${files[@]}"} >"$answer" || status=$?

if [[ -f out/two_bodies.pvd ]]; then
    # Debian's Python, because the VTK package belongs to it.
    xvfb-run --auto-servernum /usr/bin/python3 evaluation/demos/render_two_bodies.py out/two_bodies.pvd out/two_bodies.png >&2 ||
        fail 'the picture could not be drawn, see above'
    say "For ParaView: $root/out/two_bodies.pvd"
    say "Picture:      $root/out/two_bodies.png"
fi
cat "$answer"
exit "$status"
