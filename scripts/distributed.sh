#!/usr/bin/env bash
# Measures what a distributed scene takes on this machine, and works out from that what it would take on many.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/distributed.sh [run|docs]

run (default): the demo distributed on 1 to 4 ranks of this machine, seven times each, and divisions of up to a million
bodies into up to 1000 parts; three minutes on two quiet cores, beside the build. Writes out/distributed/measured.csv, a row
for each rank and run, out/distributed/parts.csv, a row for each part, and what scripts/draw_distributed.py makes of them.
docs: runs nothing; takes the last figures over into docs/distributed.md and docs/distributed/.
Exit status: 0 when drawn, 1 when something failed, 2 for a wrong command line.
END
}

runs=true
case "${1:-run}" in
    run) ;;
    docs) runs=false ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

install_packages python3-matplotlib python3-numpy
if [[ $runs == false ]]; then
    [[ -r out/distributed/parts.csv ]] || fail "there is no out/distributed/parts.csv yet: run 'scripts/distributed.sh' first"
    /usr/bin/python3 scripts/draw_distributed.py out/distributed docs/distributed.md >&2 || fail 'the chart could not be drawn'
    mkdir -p docs/distributed
    cp out/distributed/{measured.csv,model.csv,scaling.svg} docs/distributed/
    say "Renewed: $root/docs/distributed.md"
    exit 0
fi

scripts/setup.sh
say 'Building (release)'
cmake --workflow --preset demos >&2 || fail 'the build failed, see above'
programs="$root/build/demos/demos"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1

mkdir -p out/distributed
rm -f out/distributed/measured.csv
for run in 1 2 3 4 5 6 7; do
    say "Run $run of 7"
    # One rank at several sizes says what a ray takes; more ranks are what is predicted.
    for bodies in 60 120 220 330; do
        mpirun -n 1 "$programs/distributed" --bodies $bodies --steps 6 --csv out/distributed/measured.csv >/dev/null
    done
    for ranks in 2 3 4; do
        for rebalance in 2 4; do
            mpirun --oversubscribe -n $ranks "$programs/distributed" --steps 6 --rebalance $rebalance \
                --csv out/distributed/measured.csv >/dev/null
        done
    done
done

say 'Dividing'
rm -f out/distributed/parts.csv
for division in 60/1 120/1 220/1 330/1 1000000/10 1000000/100 1000000/1000 10000/10 100000/100 1000/10 10000/100 100000/1000; do
    "$programs/distributed_parts" "${division%/*}" "${division#*/}" >>out/distributed/parts.csv
done
head_csv out/distributed/measured.csv none 'scripts/distributed.sh'
/usr/bin/python3 scripts/draw_distributed.py out/distributed || fail 'the chart could not be drawn, see above'
say "Chart: $root/out/distributed/scaling.svg"
