#!/usr/bin/env bash
# What the library is made of: versions, licences, sources.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/supply_chain.sh [--long]

Checks that every call of cargo in scripts and CMake files uses the committed versions (--locked), and that the library
compiles with the oldest versions that Cargo.toml allows.
With --long also tests and examples, and licences, sources and duplicates, by deny.toml, of every package here; cargo-deny
is built into target/tools first where it is missing, which takes minutes. Known vulnerabilities need a database from the
network: cargo deny check advisories.
Exit status: 0 when all is as it should be, 1 when something is not, 2 for a wrong command line.
END
}

long=false
parts=(--lib)
case "${1:-}" in
    '') ;;
    --long) long=true parts=(--all-targets) ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

say 'committed versions'
# Calls stand at the start of a line, behind a variable's value or another command's name; a call may end in other lines.
unlocked="$(grep -rnE '^[^#]*\bcargo (build|run|test|clippy|doc|check|install)\b' scripts .ci packaging/cmake |
    grep -vE -- '--locked|Runs, in this order|for tool in')" || true
[[ -z "$unlocked" ]] || fail "without --locked: $unlocked"

say 'oldest versions'
copy="$(mktemp -d)"
trap 'rm -rf "$copy"' EXIT
git ls-files -z | xargs -0 cp --parents -t "$copy"
(
    cd "$copy"
    # The option is not a stable one.
    RUSTC_BOOTSTRAP=1 cargo update --quiet -Z direct-minimal-versions &&
        CARGO_TARGET_DIR="$root/target/oldest" cargo check --locked --quiet "${parts[@]}"
) || fail 'the oldest versions that Cargo.toml allows will not do: raise those that the errors above are about'

if [[ $long == true ]]; then
    export PATH="$root/target/tools/bin:$PATH"
    command -v cargo-deny >/dev/null || cargo install --locked --quiet --root target/tools cargo-deny
    for manifest in Cargo.toml evaluation/bench/Cargo.toml tests/fuzz/Cargo.toml; do
        say "licences, duplicates and sources: $manifest"
        cargo deny --locked --manifest-path "$manifest" --config deny.toml check licenses bans sources
    done
fi
say 'the supply chain is as it should be'
