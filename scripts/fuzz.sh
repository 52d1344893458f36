#!/usr/bin/env bash
# Feeds the library with inputs that nobody chose, led by what they reach, under the address sanitizer.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

targets=(surface obj_file differential host options)

usage() {
    cat <<END
usage: scripts/fuzz.sh [--seconds N] [--seed S] [--only TARGET] [--input FILE]

Builds tests/fuzz/ with libFuzzer, which sees the code that an input reaches, and the address sanitizer, then runs each target
from the inputs in tests/fuzz/corpus/, a few that together reach what all that were tried did. The stable compiler does it;
RUSTC_BOOTSTRAP allows the sanitizer.
  --seconds N    for each target (default 15)
  --seed S       of the random changes (default: another each time)
  --only TARGET  one of ${targets[*]} (default: all)
  --input FILE   this input of --only alone
What is new is kept in target/fuzz/corpus/, an input that ends in a fault in target/fuzz/faults/.
surface: meshes from bytes. obj_file: .obj files from bytes. differential: rays through both octrees and against every
triangle, and contacts of a mesh with itself. host: calls of the C interface in any order its rules allow. options: bodies
in any pose, asked for contacts with any options. An input that does not end in two minutes (options: half a minute) is a
fault too.
Exit status: 0 without a fault, 1 with one, 2 for a wrong command line.
END
}

seconds=15
seed=0
only=''
input=''
while (($#)); do
    case "$1" in
        --seconds) seconds="${2:-}" && shift ;;
        --seed) seed="${2:-}" && shift ;;
        --only) only="${2:-}" && shift ;;
        --input) input="$(absolute_path "${2:-}")" && shift ;;
        -h | --help) usage && exit 0 ;;
        *) usage >&2 && fail "unknown argument '$1'" 2 ;;
    esac
    shift
done
[[ "$seconds" =~ ^[0-9]+$ ]] || fail "--seconds takes a whole number, not '$seconds'" 2
[[ "$seed" =~ ^[0-9]+$ ]] || fail "--seed takes a whole number, not '$seed'" 2
[[ -z "$only" || " ${targets[*]} " == *" $only "* ]] || fail "there is no target '$only'; give one of: ${targets[*]}" 2
[[ -z "$input" || -n "$only" ]] || fail '--input needs --only' 2
[[ -z "$only" ]] || targets=("$only")

host="$(rustc --version --verbose | sed -n 's/^host: //p')"
folder="$root/target/fuzz"
# For this processor alone: what others would run is never reached here, and takes two thirds of the build.
coverage=(level=4 inline-8bit-counters pc-table trace-compares stack-depth)
RUSTC_BOOTSTRAP=1 CARGO_TARGET_DIR="$folder" \
    RUSTFLAGS="--cfg fuzzing -Ctarget-cpu=native -Zsanitizer=address -Cpasses=sancov-module \
${coverage[*]/#/-Cllvm-args=-sanitizer-coverage-}" \
    cargo build --release --locked --quiet --manifest-path tests/fuzz/Cargo.toml --target "$host" ||
    fail 'the build failed, see above'

program() { echo "$folder/$host/release/$1"; }
if [[ -n "$input" ]]; then
    "$(program "$only")" "$input" || fail "$only: a fault"
    exit 0
fi

# fuzz <target>
fuzz() {
    local target="$1" known="$folder/known/$1" new="$folder/corpus/$1" log="$folder/$1.log" most_seconds=120
    [[ "$target" != options ]] || most_seconds=30
    rm -rf "$known"
    mkdir -p "$known" "$new" "$folder/faults"
    tar -xzf "tests/fuzz/corpus/$target.tar.gz" -C "$known"
    "$(program "$target")" -seed="$seed" -max_total_time="$seconds" -max_len=512 -timeout="$most_seconds" \
        -rss_limit_mb=4096 -print_final_stats=1 -artifact_prefix="$folder/faults/$target-" "$new" "$known" >"$log" 2>&1 ||
        fail "$target: a fault. $(grep -m 1 -E 'ERROR|panicked|SUMMARY' "$log"); all of it: $log; the input: \
$(sed -n 's/.*Test unit written to //p' "$log")"
    local executions edges
    executions="$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")"
    edges="$(grep -oE ' cov: [0-9]+' "$log" | tail -n 1 | grep -oE '[0-9]+')"
    printf '%-14s %9d executions, %6d edges reached, no fault\n' "$target" "$executions" "$edges"
}
printf '%s\n' "${targets[@]}" | side_by_side fuzz || exit 1
