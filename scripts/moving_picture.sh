#!/usr/bin/env bash
# Runs deep starts in Bullet and MuJoCo, with raycontact and with their own contacts, and draws them beside one another.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/moving_picture.sh

Installs what is missing, builds the demos, runs Bullet's scene two_tori and MuJoCo's skins with raycontact and with the host's
own contact, and draws docs/images/deep_start.gif, the README's moving picture. ParaView files: out/moving_picture/.
Exit status: 0 when drawn, 1 when something failed, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

scripts/setup.sh
scripts/mujoco.sh
say 'Building the demos (release)'
{ cmake --preset demos && cmake --build --preset demos --target scene_two_tori mujoco_flexes; } >&2 ||
    fail 'the build failed, see above'

programs=build/demos/demos
out=out/moving_picture
mkdir -p "$out"/{ours,vf_dd_implicit,raycontact,mujoco}
# A verdict other than ok is what the picture shows of some.
for method in ours vf_dd_implicit; do
    "$programs/scenes/two_tori" --method "$method" --dt 0.0083333 --steps 180 --out "$out/$method" || (($? == 1))
done
for contact in raycontact mujoco; do
    # MuJoCo writes its warnings to a file where it runs.
    (cd "$out" && "$root/$programs/mujoco_flexes" skins --contact "$contact" --out "$contact") || (($? == 1))
done
xvfb-run --auto-servernum /usr/bin/python3 evaluation/demos/render_moving_picture.py docs/images/deep_start.gif \
    "raycontact in Bullet=$out/ours/two_tori.pvd@1.2" \
    "Bullet's own contact=$out/vf_dd_implicit/two_tori.pvd@1.2" \
    "raycontact in MuJoCo=$out/raycontact/mujoco_skins.pvd@0.15" \
    "MuJoCo's own contact=$out/mujoco/mujoco_skins.pvd@0.15" || fail 'the picture could not be drawn, see above'
