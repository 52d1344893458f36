#!/usr/bin/env bash
# Runs the scenes with every contact method, time step and stiffness, and draws where each stays stable.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/stability.sh [quick|full|docs]

quick (default): all scenes and methods at three time steps with the stiffness that the bodies suggest; some minutes.
full: nine time steps from 1/480 to 0.5 s, three stiffnesses a hundred times apart; several hours on two cores.
docs: runs nothing; takes the last map over into docs/stability.md and docs/stability/.
A run lasts as long as the scene says, at most 200 steps (full: 600), and is given up after 20 s (full: 60 s) of processor
time: "unfinished". All methods get the same cells; those without a stiffness (classic bodies) run once for each time step.
Writes out/stability/map.csv, and out/stability/<scene>.svg: verdicts by time step and stiffness, a panel a method.
RAYCONTACT_SCENES, _METHODS, _STEPS (in s), _FACTORS (of the suggested stiffness): these instead, separated by spaces.
RAYCONTACT_LIMITS: other limits, "steps seconds". With any of them the last map's other lines are kept.
Exit status: 0 when drawn, 1 when something failed, 2 for a wrong command line.
END
}

most_steps=200
most_seconds=20
runs=true
case "${1:-quick}" in
    quick) steps=(0.016667 0.05 0.1) factors=(1) ;;
    full) steps=(0.0020833 0.0041667 0.0083333 0.016667 0.033333 0.05 0.1 0.2 0.5) factors=(0.1 1 10) most_steps=600 most_seconds=60 ;;
    docs) runs=false ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

is_part=false
[[ -z "${RAYCONTACT_SCENES:-}${RAYCONTACT_METHODS:-}${RAYCONTACT_STEPS:-}${RAYCONTACT_FACTORS:-}" ]] || is_part=true
[[ -z "${RAYCONTACT_STEPS:-}" ]] || read -ra steps <<<"$RAYCONTACT_STEPS"
[[ -z "${RAYCONTACT_FACTORS:-}" ]] || read -ra factors <<<"$RAYCONTACT_FACTORS"
[[ -z "${RAYCONTACT_LIMITS:-}" ]] || read -r most_steps most_seconds <<<"$RAYCONTACT_LIMITS"
# The longest last.
read -ra scenes <<<"${RAYCONTACT_SCENES:-boxes_edge_on_edge fast_impact heavy_on_light spike_into_slab fine_on_coarse \
folding_strip swallowed_body offset_stack falling_tori growing_tori box_stack plate_through_ring mixed_pile two_tori ring_chain}"
read -ra methods <<<"${RAYCONTACT_METHODS:-ours pressure contact_system paper classic vf_dd_implicit vf_dd_explicit vf_ss cl_ss}"
header=scene,method,dt,stiffness,inside_start,inside_end,inverted,peak_speed,energy_end,momentum_drift,links_kept,verdict

install_packages python3-matplotlib
if [[ $runs == false ]]; then
    [[ -r out/stability/map.csv ]] || fail "there is no out/stability/map.csv yet: run 'scripts/stability.sh full' first"
    cp out/stability/map.csv docs/stability/
    /usr/bin/python3 scripts/draw_stability.py docs/stability || fail 'the map could not be drawn'
    /usr/bin/python3 scripts/figures.py --renew || fail 'the pages could not be renewed, see above'
    say "Renewed: $root/docs/stability.md"
    exit 0
fi

scripts/setup.sh
say 'Building (release)'
cmake --workflow --preset demos >&2 || fail 'the build failed, see above'
programs="$root/build/demos/demos/scenes"

# one_run <scene> <method> <dt> <stiffness>: its line of the map. A crash or a run that takes too long is a verdict too.
one_run() {
    local line
    # Of the processor, so that the verdict does not depend on what else the machine does.
    line="$(ulimit -t "$most_seconds" && "$programs/$1" --method "$2" --dt "$3" --stiffness "$4" \
        --most-steps "$most_steps" 2>/dev/null)" || true
    [[ -n "$line" ]] || line="$1,$2,$(printf '%.4g,%.4g' "$3" "$4"),,,,,,,,unfinished"
    echo "$line"
}
export -f one_run
export programs most_steps most_seconds

# Bullet's classic bodies know no stiffness of contact: one run is enough.
jobs_of_the_map() {
    local scene method dt factor suggested
    for scene in "${scenes[@]}"; do
        [[ -x "$programs/$scene" ]] || fail "there is no scene '$scene'"
        suggested="$("$programs/$scene" --suggested-stiffness)"
        for method in "${methods[@]}"; do
            for dt in "${steps[@]}"; do
                for factor in "${factors[@]}"; do
                    case "$method" in classic | vf_ss | cl_ss) [[ "$factor" == 1 ]] || continue ;; esac
                    printf '%s %s %s %s\n' "$scene" "$method" "$dt" "$(awk "BEGIN { print $suggested * $factor }")"
                done
            done
        done
    done
}

# with_progress <count>: passes lines on, and shows a person how many of them have come.
with_progress() {
    local finished=0 line
    while IFS= read -r line; do
        printf '%s\n' "$line"
        finished=$((finished + 1))
        [[ ! -t 2 ]] || printf '\r%*s of %d runs, %3d %%' "${#1}" "$finished" "$1" $((100 * finished / $1)) >&2
    done
    [[ ! -t 2 ]] || echo >&2
}

mkdir -p out/stability
jobs_of_the_map >out/stability/jobs.txt
count="$(wc -l <out/stability/jobs.txt)"
say "Running $count scenes on $(nproc) cores"
{
    echo "$header"
    xargs -P "$(nproc)" -L 1 bash -c 'one_run "$@"' one_run <out/stability/jobs.txt | with_progress "$count"
} >out/stability/map.csv.part || fail 'the scenes could not be run, see above'
[[ $is_part == true && -r out/stability/map.csv ]] || echo "$header" >out/stability/map.csv
# Of two lines for the same scene, method, time step and stiffness the later one counts.
sed '/^#/d' out/stability/map.csv | sed 1d | cat out/stability/map.csv.part - | awk -F, -v OFS=, 'NR == 1 || !seen[$1, $2, $3 + 0, $4 + 0]++' |
    { read -r first && echo "$first" && sort; } >out/stability/map.csv.new
mv out/stability/map.csv.new out/stability/map.csv
rm out/stability/map.csv.part
head_csv out/stability/map.csv none 'scripts/stability.sh'
/usr/bin/python3 scripts/draw_stability.py out/stability || fail 'the map could not be drawn, see above'
say "Map: $root/out/stability/map.csv"
