#!/usr/bin/env bash
# Measures the forces in release and renews the tables and charts of docs/accuracy.md.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/accuracy.sh [--help]

Runs the programs forces, figure8 and convergence, writes docs/accuracy/forces.csv, figure8.csv and convergence.csv, draws
figure8.svg and convergence.svg beside them, and renews the tables of docs/accuracy.md: about three minutes after the
build. The figures do not depend on the machine's speed or its number of cores. Debian's python3-matplotlib is installed
first where it is missing.
Exit status: 0 when drawn and all targets are met, 1 when not or when something failed, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

command -v cargo >/dev/null || fail "'cargo' is missing: install a Rust toolchain (https://rustup.rs)"
install_packages python3-matplotlib

say 'Building (release)'
cargo build --release --locked --example measure >&2 || fail 'the build failed, see above'

# Copied at the end: an interrupted run leaves the old figures.
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
measure="$(absolute_path "${CARGO_TARGET_DIR:-$root/target}")/release/examples/measure"
are_met=yes
for program in forces figure8 convergence; do
    say "Measuring: $program"
    "$measure" "$program" >"$scratch/$program.csv" || {
        (($? == 1)) || fail "$program ended early, see above"
        are_met=no
    }
    head_csv "$scratch/$program.csv" "$([[ $program == forces ]] && echo 1 || echo none)" 'scripts/accuracy.sh'
done
/usr/bin/python3 scripts/draw_accuracy.py "$scratch" || fail 'the charts could not be drawn, see above'
mkdir -p docs/accuracy
cp "$scratch"/{forces.csv,{figure8,convergence}.{csv,svg}} docs/accuracy/
/usr/bin/python3 scripts/figures.py --renew || fail 'the pages could not be renewed, see above'
say "Figures and charts: $root/docs/accuracy/"
[[ "$are_met" == yes ]] || fail 'a target was missed, see above'
