#!/usr/bin/env bash
# Measures speed against accuracy: every method over its settings on six scenes.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/chart.sh [quick|full|docs] [options of the measuring program]

quick (default): one option at a time beside the default, some five minutes after the build.
full: each option with each other, three times as long.
docs: measures nothing; takes the last measurement over into docs/choosing.md and docs/chart/.
Writes out/chart/chart.csv and charts beside it, and prints the settings of each scene that none beats in both time and
force. Further options go to the measuring program ('scripts/chart.sh quick --help' lists them). Two surfaces of your
own as one scene more, or alone, with spacings of your own, in edges:
  scripts/chart.sh quick --files a.obj b.obj
  scripts/chart.sh quick --scenes given --files a.obj b.obj --spacings 1,3,9
Exit status: 0 when measured, 1 when something failed, 2 for a wrong command line.
END
}

source scripts/peers.sh
start_measuring out/chart/chart.csv docs/chart "$@"
command="scripts/chart.sh $*"
(($# == 0)) || shift

if [[ $measures == false ]]; then
    "$bench" chart --draw --out docs/chart --document docs/choosing.md
    install_packages python3-matplotlib
    /usr/bin/python3 scripts/draw_choices.py docs/chart || fail 'the chart of choices could not be drawn, see above'
    scripts/figures.py --renew || fail 'the pages could not be renewed, see above'
    say "Renewed: $root/docs/choosing.md; 'scripts/report.sh' renews the page"
    exit 0
fi
# Names of files are the caller's.
options=()
for option in "$@"; do
    [[ -f "$caller_dir/$option" ]] && option="$(absolute_path "$option")"
    options+=("$option")
done
"$bench" chart "${size[@]}" --out out/chart "${libraries[@]}" "${options[@]}"
head_csv out/chart/chart.csv none "$command"
say "Figures and charts: $root/out/chart"
