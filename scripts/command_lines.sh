#!/usr/bin/env bash
# Every program of the repository keeps the same habits on the command line.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/command_lines.sh [--help]

Runs every program with --help and with an unknown option: --help prints the usage and the exit statuses and ends with 0, an
unknown option is named on standard error and ends with 2, and nothing is coloured that is not a terminal. On a
terminal, colour is there, and not with NO_COLOR. The demos contacts and two_bodies, which read the same files, end with
the same status for the same fault. The demos are those of 'cmake --workflow --preset test'.
Exit status: 0 when all programs keep to it, 1 when one does not, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

cargo build --release --locked --quiet --example measure --example creation
examples="${CARGO_TARGET_DIR:-$root/target}/release/examples"
measure="$examples/measure"
demos="$root/build/test/demos"
programs=("$root"/scripts/*.sh "$root"/scripts/*.py "$measure" "$examples/creation")
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

# habits <program> [its part]
habits() {
    run 0 "$@" --help
    grep -qi '^usage: ' "$out/stdout" || fail "'$* --help' does not print its usage"
    grep -qi 'exit status: ' "$out/stdout" || fail "'$* --help' does not say its exit statuses"
    run 2 "$@" --no-such-option
    grep -q -- 'no-such-option' "$out/stderr" || fail "'$*' does not name the option it does not know"
    [[ ! -s "$out/stdout" ]] || fail "'$*' says what is wrong on standard output"
    count=$((count + 1))
}

for program in "${programs[@]}"; do
    # What is not executable is sourced or imported by others, and no program.
    [[ ! -x "$program" ]] || habits "$program"
done

# One program has many parts.
run 2 "$measure"
grep -q '^usage: ' "$out/stderr" && [[ ! -s "$out/stdout" ]] || fail "'measure' alone does not print its usage as an error"
run 2 "$measure" none
unknown="$(<"$out/stderr")"
mapfile -t parts < <("$measure" --help | sed -n 's/^  \([a-z0-9_]*\)  .*/\1/p')
((${#parts[@]} > 10)) || fail "'measure --help' lists no more than ${parts[*]}"
for part in "${parts[@]}"; do
    [[ "$unknown" == *" $part"* ]] || fail "'measure none' does not name $part"
    habits "$measure" "$part"
    [[ "$("$measure" "$part" --help)" == *"measure -- $part "* ]] || fail "'measure $part --help' has another usage"
done

# The same files and the same faults for both programs that take two of them.
corners="v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
printf '%b' "${corners}f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n" >"$out/closed.obj"
printf '%b' "${corners}f 1 3 2\nf 1 2 4\nf 1 4 3\n" >"$out/open.obj"
printf '%b' "${corners}f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n" >"$out/inward.obj"
printf '%b' "${corners}f 1 2 3\nf 1 3 2\n" >"$out/flat.obj"
printf '%b' "${corners}f 1 3 9\n" >"$out/broken.obj"
printf '%b' "${corners/0 0 1/0 0 nan}f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n" >"$out/nan.obj"
: >"$out/empty.obj"
printf '%b' 'solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n' >"$out/stl.obj"
printf '%b' 'ply\nformat ascii 1.0\nelement vertex 3\nelement face 1\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >"$out/ply.obj"
mkdir "$out/folder.obj"

# fault <expected status> <what standard error says> <argument>...
fault() {
    local expected="$1" said="$2" program
    shift 2
    for program in "$demos/contacts" "$demos/two_bodies"; do
        run "$expected" "$program" "$@"
        grep -q -- "$said" "$out/stderr" || fail "'$program $*' does not say '$said': $(head -n 3 "$out/stderr")"
        [[ ! -s "$out/stdout" ]] || fail "'$program $*' says what is wrong on standard output"
    done
}

for program in "$demos/contacts" "$demos/two_bodies"; do
    run 0 "$program" --help
    grep -q 'Exit status: 0 .*2 wrong usage or unusable input' "$out/stdout" || fail "'$program --help' tells other statuses"
    run 0 "$program" --no-such-option --help
done
while read -r file said; do
    fault 2 "$file.obj.*$said" "$out/$file.obj" "$out/closed.obj"
    fault 2 "$file.obj.*$said" "$out/closed.obj" "$out/$file.obj"
done <<END
missing No such file
folder directory
empty no line of a face
stl only .obj files are read: convert
ply only .obj files are read: convert
broken line 5
open open
inward inside out
flat encloses no volume
nan NaN
END
fault 2 'two .obj files' "$out/closed.obj"
fault 2 'file' "$out/closed.obj" "$out/closed.obj" "$out/closed.obj"
fault 2 'no-such-option' "$out/closed.obj" "$out/closed.obj" --no-such-option
fault 2 '--spacing' "$out/closed.obj" "$out/closed.obj" --spacing
fault 2 '--spacing' "$out/closed.obj" "$out/closed.obj" --spacing up
fault 2 '--spacing' "$out/missing.obj" "$out/closed.obj" --spacing nan

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
