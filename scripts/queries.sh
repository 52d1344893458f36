#!/usr/bin/env bash
# Measures nearest points and signed distances of this library beside others.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/queries.sh [--help] [options of evaluation/queries/measure.py]

Installs this library as a wheel and its peers in a virtual environment in target/queries, and runs
evaluation/queries/measure.py there, which says what it measures: ten minutes after the build. Further closed surfaces are
asked about with --files a.obj,b.obj. Writes out/queries/queries.csv; copied to docs/performance, it is what
scripts/figures.py --renew takes.
Exit status: 0 when measured, 1 when something failed, 2 for a wrong command line.
END
}

for option in "$@"; do
    case "$option" in
        -h | --help) usage && exit 0 ;;
        --files | --files=* | --points | --points=* | --rounds | --rounds=* | --seed | --seed=*) ;;
        -*) usage >&2 && fail "unknown argument '$option'" 2 ;;
    esac
done

environment="$root/target/queries/venv"
source scripts/wheel.sh
install_wheel "$environment" "$root/target/queries/wheel" numpy==2.4.6
# Open3D's wheel wants the last three.
install_packages libembree-dev libcgal-dev libusb-1.0-0 libgl1 libgomp1
"$environment/bin/pip" install embreex==4.4.0.post1 fcpw==1.2.0 libigl==2.6.3 open3d==0.20.0 rtree==1.4.1 scipy==1.17.1 \
    trimesh==5.2.0 || fail 'pip could not install the other libraries'
# CGAL checks what it does without the first of these.
c++ -DNDEBUG -std=c++17 -Wall -Wextra -O3 -march=native -shared -fPIC -Ievaluation/bench/peers/cpp \
    evaluation/queries/peers.cpp -o "$root/target/queries/peers.so" -lgmp -lmpfr -ldl || fail 'evaluation/queries/peers.cpp could not be built'

say 'Measuring'
mkdir -p "$root/out/queries"
"$environment/bin/python" evaluation/queries/measure.py --peers "$root/target/queries/peers.so" "$@" \
    "$root/out/queries/queries.csv" || fail 'the measurement failed, see above'
head_csv out/queries/queries.csv 1 'scripts/queries.sh'
say "Figures: $root/out/queries/queries.csv"
