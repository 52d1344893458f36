#!/usr/bin/env bash
# Holds the hash of five scenes, over threads, instructions and builds, to tests/golden_hash.txt.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/hashes.sh [--long|--renew]

Runs the program 'hash' with 1, 2, 3, 8 and 16 threads and with threads of its own, with the instructions of each
processor that this one can play (RAYCONTACT_SIMD), and with --long in a debug build; each time the last line must be that
of tests/golden_hash.txt. --renew writes that file instead, where results are meant to change.
Exit status: 0; 1 where a hash differs; 2 for a wrong command line.
END
}

golden=tests/golden_hash.txt
long=false
case "${1:-}" in
    '') ;;
    --long) long=true ;;
    --renew) cargo run --release --locked --quiet --example measure -- hash | tail -n 1 >"$golden" ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

paths=(baseline)
grep -qw avx2 /proc/cpuinfo && grep -qw fma /proc/cpuinfo && paths+=(avx2)
grep -qw avx512f /proc/cpuinfo && paths+=(avx512)

# same <what it is> <command>...
same() {
    local what="$1" found
    shift
    found="$("$@" | tail -n 1)"
    [[ "$found" == "$(<"$golden")" ]] || fail "$what: $found instead of $(<"$golden")"
    printf '%-28s %s\n' "$what" "$found"
}

cargo build --release --locked --quiet --example measure
program=("${CARGO_TARGET_DIR:-target}/release/examples/measure" hash)
for threads in 1 2 3 8 16; do
    same "$threads threads" "${program[@]}" --threads "$threads"
done
same 'threads of the program' "${program[@]}" --host 3
for path in "${paths[@]}"; do
    same "$path" env RAYCONTACT_SIMD="$path" "${program[@]}" --threads 2
done
[[ $long == false ]] || same 'debug build' cargo run --locked --quiet --example measure -- hash
