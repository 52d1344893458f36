#!/usr/bin/env bash
# Installs what is missing, builds in release, runs every scene with raycontact's contact and draws its start and end.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/scenes.sh [scene]...

Runs the scenes of evaluation/demos/scenes/ (all of them, or those named), each for at most 500 steps, writes ParaView files and a
picture of each under out/scenes/, copies the pictures to docs/images/scenes/ and prints each scene's line, as in
scripts/stability.sh.
Exit status: 0 when every scene ended well, 1 when not or when something failed, 2 for a wrong command line.
END
}

case "${1:-}" in
    -h | --help) usage && exit 0 ;;
    -*) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

scripts/setup.sh
say 'Building (release)'
cmake --workflow --preset demos >&2 || fail 'the build failed, see above'

programs=build/demos/demos/scenes
names=("$@")
if ((${#names[@]} == 0)); then
    for file in evaluation/demos/scenes/*.cpp; do names+=("$(basename "$file" .cpp)"); done
fi
mkdir -p out/scenes docs/images/scenes
status=0
for name in "${names[@]}"; do
    [[ -x "$programs/$name" ]] || fail "there is no scene '$name'"
    "$programs/$name" --most-steps 500 --out out/scenes || status=1
    # Debian's Python, because the VTK package belongs to it.
    xvfb-run --auto-servernum /usr/bin/python3 evaluation/demos/render_two_bodies.py "out/scenes/$name.pvd" \
        "docs/images/scenes/$name.png" --width 800 >&2 || fail 'the picture could not be drawn, see above'
done
exit "$status"
