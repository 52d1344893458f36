#!/usr/bin/env bash
# Counts the instructions of a step of detection and compares them with the committed counts: a guard that does not
# depend on how fast or busy the machine is.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

counts=docs/performance/instructions.csv
tolerance=2 # per cent; one compiler always counts the same, and a new version of it may need --renew

usage() {
    cat <<END
usage: scripts/instructions.sh [--renew]

Runs each workload and mode of $counts under valgrind's callgrind, with the AVX2 path (valgrind knows no AVX-512) and
with the baseline path, and compares the instructions of one step with the committed ones.
--renew writes what it counted to that file instead of comparing.
Exit status: 0 when no count has risen by more than $tolerance %, 1 when one has, 2 for a wrong command line.
END
}

renew=false
case "${1:-}" in
    '') ;;
    --renew) renew=true ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

scripts/setup.sh
cargo build --release --locked --quiet --example measure || fail 'the build failed, see above'
program="${CARGO_TARGET_DIR:-target}/release/examples/measure"

# instructions <simd path> <workload> <mode> <steps>
instructions() {
    local log
    log="$(RAYCONTACT_SIMD="$1" valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        "$program" steps --workload "$2" --mode "$3" --steps "$4" 2>&1)" || fail "valgrind failed: $log"
    sed -n 's/.*Collected : *//p' <<<"$log"
}

# The first steps also allocate.
per_step() { echo $((($(instructions "$@" 12) - $(instructions "$@" 4)) / 8)); }

measured="$(mktemp)"
trap 'rm -f "$measured"' EXIT
# count <workload> <mode> <simd path>
count() {
    local found
    found="$(per_step "$3" "$1" "$2")" || exit 1
    say "$1, $2, $3: $found"
    echo "$1,$2,$3,$found" >>"$measured"
}
for workload in stack2 stack10 pair80x40 deep80 boxes; do
    for mode in paper default; do
        printf '%s\n' "$workload $mode avx2" "$workload $mode baseline"
    done
done | side_by_side count || exit 1
sort -o "$measured" "$measured"
sed -i '1i workload,mode,path,instructions' "$measured"

if [[ $renew == true ]]; then
    head_csv "$measured" none 'scripts/instructions.sh --renew'
    cp "$measured" "$counts"
    say "Renewed: $counts"
    exit 0
fi

[[ -r $counts ]] || fail "there is no $counts: write it with scripts/instructions.sh --renew"
join -t, -j1 <(sed '/^#/d' "$counts" | sed '1d;s/,/ /;s/,/ /' | sort) <(sed '1d;s/,/ /;s/,/ /' "$measured" | sort) |
    awk -F, -v tolerance="$tolerance" '{
        change = 100 * ($3 / $2 - 1)
        printf "%-28s %12d -> %12d  %+6.1f %%\n", $1, $2, $3, change
        if (change > tolerance) risen = 1
    }
    END { exit risen }' || fail "a step takes over $tolerance % more instructions than committed. If that is meant, \
renew the counts: scripts/instructions.sh --renew"
