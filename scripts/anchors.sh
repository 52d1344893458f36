#!/usr/bin/env bash
# Measures this library beside coal and the IPC Toolkit where two bodies touch.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/anchors.sh [--help] [options of scripts/measure_anchors.py]

Installs this library as a wheel, coal and the IPC Toolkit in the virtual environment of scripts/penetration.sh, and runs
scripts/measure_anchors.py there, which says what it measures; a few minutes after the build. Writes
out/anchors/anchors.csv.
Exit status: 0 when measured, 1 when something failed, 2 for a wrong command line.
END
}

for option in "$@"; do
    case "$option" in
        -h | --help) usage && exit 0 ;;
        --rounds | --rounds=* | --sizes | --sizes=*) ;;
        -*) usage >&2 && fail "unknown argument '$option'" 2 ;;
    esac
done

environment="$root/target/penetration/venv"
source scripts/wheel.sh
install_wheel "$environment" "$root/target/penetration/wheel" numpy==2.4.6
"$environment/bin/pip" install coal==3.0.3 ipctk==1.6.1 scipy==1.17.1 || fail 'pip could not install the other libraries'

say 'Measuring'
mkdir -p "$root/out/anchors"
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 "$environment/bin/python" scripts/measure_anchors.py "$@" \
    "$root/out/anchors/anchors.csv" || fail 'the measurement failed, see above'
head_csv out/anchors/anchors.csv none 'scripts/anchors.sh'
say "Figures: $root/out/anchors/anchors.csv"
