#!/usr/bin/env bash
# Every program of the repository keeps the same habits on the command line.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/command_lines.sh [--help]

Runs every program with --help and with an unknown option: --help prints the usage and the exit statuses and ends with 0, an
unknown option is named on standard error and ends with 2, and nothing is coloured that is not a terminal. On a
terminal, colour is there, and not with NO_COLOR. The demos are those of 'cmake --workflow --preset test'.
Exit status: 0 when all programs keep to it, 1 when one does not, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

cargo build --release --locked --quiet --examples
demos="$root/build/test/demos"
programs=("$root"/scripts/*.sh "$root"/scripts/*.py)
for example in "$root"/examples/*.rs "$root"/examples/*/main.rs; do
    name="$(basename "${example%/main.rs}" .rs)"
    programs+=("$root/target/release/examples/$name")
done
for demo in "$demos"/* "$demos"/scenes/*; do
    [[ -f "$demo" && -x "$demo" ]] && programs+=("$demo")
done

escape=$'\e'
out="$(mktemp -d)"
trap 'rm -rf "$out"' EXIT

# run <expected status> <program> <argument>...
run() {
    local expected="$1" status=0
    shift
    "$@" >"$out/stdout" 2>"$out/stderr" </dev/null || status=$?
    ((status == expected)) || fail "'$*' ended with $status, not $expected: $(tail -n 3 "$out/stderr")"
    ! grep -q "$escape" "$out/stdout" "$out/stderr" || fail "'$*' colours what is not a terminal"
}

count=0
for program in "${programs[@]}"; do
    [[ "$program" == */common.sh || "$program" == */peers.sh ]] && continue
    run 0 "$program" --help
    grep -qi '^usage: ' "$out/stdout" || fail "'$program --help' does not print its usage"
    grep -qi 'exit status: ' "$out/stdout" || fail "'$program --help' does not say its exit statuses"
    run 2 "$program" --no-such-option
    grep -q -- 'no-such-option' "$out/stderr" || fail "'$program' does not name the option it does not know"
    [[ ! -s "$out/stdout" ]] || fail "'$program' says what is wrong on standard output"
    count=$((count + 1))
done

# colours <command>: whether it colours a terminal. `script` lends it one.
colours() {
    script --quiet --command "$1" /dev/null </dev/null >"$out/terminal"
    grep -qE "$escape\[[0-9;]*[1-9][0-9;]*m" "$out/terminal"
}

checked=(
    "$root/scripts/setup.sh --no-such-option"
    "$demos/two_bodies --steps 3 --out $out"
)
export TERM=xterm-256color
for command in "${checked[@]}"; do
    (unset NO_COLOR && colours "$command") || fail "'$command' has no colour on a terminal: is this check still one?"
    ! NO_COLOR=1 colours "$command" || fail "'$command' ignores NO_COLOR"
done
say "$count programs keep the same habits on the command line"
