#!/usr/bin/env bash
# Installs the peers, builds in release and measures raycontact beside them, all in one run.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/bench.sh [quick|full|docs] [options of the measuring program]

quick (default): every method on the ordinary workloads and two deep pairs, about ten minutes after the build.
full: also up to 409 600 triangles a body and up to 1000 bodies.
docs: measures nothing; takes the last measurement over into docs/performance_notebook.md and docs/performance/.
Writes out/bench/detect.csv and charts beside it, and prints how many times as long as raycontact-paper (the paper's
work) each method takes.
Further options go to the measuring program; with --help it lists them.
Exit status: 0 when measured, 1 when something failed, 2 for a wrong command line.
END
}

source scripts/peers.sh
start_measuring out/bench/detect.csv docs/performance "$@"
command="scripts/bench.sh $*"
(($# == 0)) || shift

if [[ $measures == false ]]; then
    "$bench" --out docs/performance --document docs/performance_notebook.md
    scripts/figures.py --renew || fail 'the pages could not be renewed, see above'
    say "Renewed: $root/docs/performance_notebook.md"
    exit 0
fi
"$bench" "${size[@]}" --out out/bench "${libraries[@]}" "$@"
head_csv out/bench/detect.csv 1 "$command"
say "Times and charts: $root/out/bench"
