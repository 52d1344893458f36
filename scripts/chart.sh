#!/usr/bin/env bash
# Measures speed against accuracy: every method over its settings on six scenes.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/chart.sh [quick|full|docs] [options of the measuring program]

quick (default): one option at a time beside the default, some three minutes after the build.
full: each option with each other, a quarter of an hour.
docs: measures nothing; takes the last measurement over into docs/chart/.
Writes out/chart/chart.csv and charts beside it, and prints the settings of each scene that none beats in both time and
force. Further options go to the measuring program ('scripts/chart.sh quick --help' lists them). Two surfaces of your
own as one scene more, or alone, with spacings of your own, in edges:
  scripts/chart.sh quick --files a.obj b.obj
  scripts/chart.sh quick --scenes given --files a.obj b.obj --spacings 1,3,9
Exit status: 0 when measured, 1 when something failed, 2 for a wrong command line.
END
}

source scripts/peers.sh
read_size "${1:-quick}"
(($# == 0)) || shift

scripts/setup.sh
bench="$(build_bench)"
if [[ $measures == false ]]; then
    [[ -r out/chart/chart.csv ]] || fail "there is no out/chart/chart.csv yet: run 'scripts/chart.sh quick' first"
    mkdir -p docs/chart
    cp out/chart/chart.csv docs/chart/
    "$bench" chart --draw --out docs/chart
    say "Renewed: $root/docs/chart; 'scripts/report.sh' renews the page"
    exit 0
fi
peers="$(build_peers)"
say 'Measuring'
"$bench" chart ${size[@]+"${size[@]}"} --out out/chart --peers "$peers" "$@"
say "Figures and charts: $root/out/chart"
