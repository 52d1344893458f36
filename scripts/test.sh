#!/usr/bin/env bash
# Installs what is missing, then runs every check of the repository, two at a time. Stops where one fails.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/test.sh [--long]

Runs, in this order: cargo fmt --check, cargo test (release), the oracle with 1e5 queries, a few sizes of the programs that
measure forces, the table of docs/stability.md, the instructions of a step, the hash of all results, 2000 steps of
self-collision, the Python package as its wheel installs it, the benchmark of deep contact without its peers, the C and C++
tests with the packages and Doxygen's manual (cmake --workflow --preset test), and the command lines of all programs. Beside
them go clippy with warnings as errors, the pages of the Rust library, the manual as one site, and the versions that the library
is made of; what these print comes at the end. Missing Debian packages are installed first, and MuJoCo is fetched. Some twenty
minutes on two cores.
With --long the oracle asks 1e7 queries, the hash is made in a debug build too, the distributed tests run on every number of
ranks, self-collision takes 1e5 steps, forces are measured at every size, as in docs/accuracy.md, licences are checked, random
inputs go in, the sanitizers run over everything, and the page of all measurements is made anew and tested in Chromium.
Exit status: 0 when everything passed, 1 at the first failure, 2 for a wrong command line.
END
}

long=false
queries=1e5
figure8=(--sides '10,150' --rotations 20)
convergence=(--largest 2000)
self_collision=(--steps 2000 --sizes 40 --idle-steps 5)
supply_chain=()
hashes=()
case "${1:-}" in
    '') ;;
    --long)
        long=true
        queries=1e7
        figure8=()
        convergence=()
        self_collision=()
        supply_chain=(--long)
        hashes=(--long)
        ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

passed=()
others=''

# Ends where what goes on beside has failed.
look_beside() {
    kill -0 "$others" 2>/dev/null && return
    wait "$others" || { cat "$printed" >&2 && fail 'what went on beside FAILED, see above'; }
    others=''
}

# check <name> <command>...
check() {
    [[ -z $others ]] || look_beside
    local name="$1" start=$SECONDS
    shift
    say "$name: $*"
    "$@" || fail "$name FAILED. To run it alone, from $root: $*"
    passed+=("$(printf '%-14s passed in %4d s' "$name" $((SECONDS - start)))")
}

check 'packages' scripts/setup.sh
check 'MuJoCo' scripts/mujoco.sh
check 'formatting' cargo fmt --check

# The compiler often leaves a core idle, so what does not build in target/release goes on beside the rest.
beside() {
    local passed=()
    check 'lints' cargo clippy --all-targets --locked -- -D warnings
    check 'Rust manual' env RUSTDOCFLAGS='-D warnings' cargo doc --no-deps --locked
    check 'manual' scripts/manual.sh
    check 'supply chain' scripts/supply_chain.sh "${supply_chain[@]}"
    printf '%s\n' "${passed[@]}"
}
printed="$(mktemp)"
beside >"$printed" 2>&1 &
others=$!
trap 'kill $others 2>/dev/null || true; rm -f "$printed"' EXIT

check 'Rust tests' cargo test --release --locked
measure=(cargo run --release --locked --quiet --example measure --)
check 'oracle' "${measure[@]}" oracle --queries "$queries" --seed 1
check 'Figure 8' "${measure[@]}" figure8 "${figure8[@]}"
check 'convergence' "${measure[@]}" convergence "${convergence[@]}"
check 'failure table' "${measure[@]}" poses --failures --count 20
check 'instructions' scripts/instructions.sh
check 'hashes' scripts/hashes.sh "${hashes[@]}"
check 'self-collision' "${measure[@]}" self_collision "${self_collision[@]}"
check 'Python' scripts/python.sh
check 'penetration' scripts/penetration.sh --check
check 'CMake' cmake --preset test -DRAYCONTACT_LONG_TESTS=$long
check 'C, C++ tests' cmake --workflow --preset test
check 'command lines' scripts/command_lines.sh
while [[ -n $others ]]; do
    sleep 1
    look_beside
done
cat "$printed"
if [[ $long == true ]]; then
    check 'fuzzing' scripts/fuzz.sh
    check 'sanitizers' scripts/sanitize.sh
    check 'page' scripts/report.sh --test
fi

say 'Summary'
printf '%s\n' "${passed[@]}"
echo 'all checks passed'
