#!/usr/bin/env bash
# Makes the page of all measurements, docs/report/index.html, from the CSV files under docs/.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/report.sh [--record] [--test]

Writes docs/report/index.html, one file that needs no network, from the CSV files under docs, the table of failures in
docs/stability.md and the recorded demos. Needs Node.js 20 or newer with npm; their packages, as evaluation/report/package-lock.json
names them, are installed into evaluation/report/node_modules first.
--record: builds and runs the demos that evaluation/report/recordings.json lists first and renews docs/report/recordings from their
frames, in some minutes; the frames stay in out/recordings, for ParaView.
--test: then opens the page in headless Chromium, which is installed where it is missing, and tests it; screenshots go to
out/report.
Exit status: 0 when made (and tested), 1 when something failed, 2 for a wrong command line.
END
}

records=false
tests=false
for argument in "$@"; do
    case "$argument" in
        --record) records=true ;;
        --test) tests=true ;;
        -h | --help) usage && exit 0 ;;
        *) usage >&2 && fail "unknown argument '$argument'" 2 ;;
    esac
done

command -v npm >/dev/null || fail 'npm is missing: install Node.js 20 or newer'
if [[ $records == true ]]; then
    scripts/setup.sh
    source scripts/peers.sh
    bench="$(build_bench)"
    cmake --workflow --preset demos >&2 || fail 'the build failed, see above'
    node evaluation/report/record.mjs build/demos/demos/scenes "$bench"
fi
if [[ ! -d evaluation/report/node_modules || evaluation/report/package-lock.json -nt evaluation/report/node_modules ]]; then
    say 'Installing the npm packages'
    npm ci --prefix evaluation/report --silent --no-audit --no-fund >&2 || fail "'npm ci' failed: is there a network?"
    touch evaluation/report/node_modules
fi
node evaluation/report/build.mjs

if [[ $tests == true ]]; then
    source scripts/peers.sh
    command -v chromium >/dev/null || install_packages chromium
    mkdir -p out/report
    node evaluation/report/test.mjs out/report
    say "Screenshots: $root/out/report"
fi
