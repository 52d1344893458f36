#!/usr/bin/env bash
# Installs what is missing, then runs every check of the repository. Stops at the first that fails.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/test.sh [--help]

Runs, in this order: cargo fmt --check, cargo clippy with warnings as errors, cargo test (release),
and the C and C++ tests (cmake --workflow --preset test). Missing Debian packages are installed first.
Exit status: 0 when everything passed, 1 at the first failure, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

passed=()

# check <name> <command>...
check() {
    local name="$1" start=$SECONDS
    shift
    say "$name: $*"
    "$@" || fail "$name FAILED. To run it alone, from $root: $*"
    passed+=("$(printf '%-14s passed in %4d s' "$name" $((SECONDS - start)))")
}

check 'packages' scripts/setup.sh
check 'formatting' cargo fmt --check
check 'lints' cargo clippy --all-targets --locked -- -D warnings
check 'Rust tests' cargo test --release --locked
check 'C, C++ tests' cmake --workflow --preset test

say 'Summary'
printf '%s\n' "${passed[@]}"
echo 'all checks passed'
