#!/usr/bin/env bash
# Runs the open benchmark of deep contact on this library and its peers, and renews the tables and charts of its page.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/penetration.sh [--quick|--full|--own|--check|--deforming [OBJ]|--solvers]

Runs evaluation/penetration-benchmark/ in a virtual environment of its own in target/penetration, with this library as a wheel and
its peers from PyPI and Debian, in fixed versions.
  --quick   (default) every tenth pose; the CSV files go to target/penetration/quick. A few minutes
  --full    installs the peers, runs all poses, scenes and bodies, and renews the CSV files in docs/penetration, the
            charts beside them and the tables of docs/penetration.md. Two hours
  --own     without peers: renews docs/penetration/quick, this library's own answers that --check asks for. A minute
  --deforming   elastic bodies, each library in its own solver, on a seed drawn once its stiffness is chosen; with a
            closed surface of yours too. Renews deforming.csv in docs/penetration, chart and tables. An hour
  --solvers the scenes of simulate, each library in its own solver, on a seed drawn once its stiffness is chosen.
            Renews solvers.csv in docs/penetration. Ten minutes
  --check   what scripts/test.sh asks, without peers: generator, judges, interface, example in C, and that this library
            still answers as in docs/penetration/quick. Under a minute
Exit status: 0 when done, 1 when something fails, 2 for a wrong command line.
END
}

size="${1:---quick}"
case "$size" in
    --quick | --full | --own | --check | --deforming | --solvers) ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

tools=(numpy==2.4.6 pytest==9.2.0 scipy==1.17.1)
peers=(coacd==1.0.14 coal==3.0.3 drake==1.51.1 embreex==4.4.0.post1 ipctk==1.6.1 matplotlib==3.11.2 mujoco==4.0.0
    python-fcl==0.7.0.11 trimesh==5.2.0)
folder="$root/target/penetration"
environment="$folder/venv"
wheels="$folder/wheel"
# Otherwise numpy's matrix products round differently on each processor, and poses on the brink end differently.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 OPENBLAS_CORETYPE=Haswell

source scripts/wheel.sh
install_wheel "$environment" "$wheels" "${tools[@]}"

cd "$root/evaluation/penetration-benchmark"
if [[ $size == --check ]]; then
    "$environment/bin/python" -m pytest -p no:cacheprovider --quiet --strict-markers tests ||
        fail 'the benchmark does not hold'
    exit 0
fi

run() { "$environment/bin/python" -m penetration_benchmark "$@" || fail 'a task failed, see above'; }
docs="$root/docs/penetration"
drawn_seed() { sed -n 's/^seed \([0-9]*\),.*/\1/p' "$1" | tail -1; }
# head_all <folder> <command>...
head_all() {
    local file
    for file in "$1"/*.csv; do head_csv "$file" 1 "${*:2}"; done
}
renew_pages() {
    "$environment/bin/python" "$root/scripts/draw_penetration.py" "$docs" || fail 'the charts could not be drawn, see above'
    "$environment/bin/python" "$root/scripts/figures.py" --renew || fail 'the pages could not be renewed, see above'
}
measure_own() {
    run "$folder/own" --share 0.1 --libraries raycontact,raycontact-paper,raycontact-own-exits \
        --tasks measure,free,detect,simulate,self
    head_all "$folder/own" scripts/penetration.sh --own
}
keep_own() {
    mkdir -p "$docs/quick"
    cp "$folder/own"/*.csv "$docs/quick/"
}
if [[ $size == --own ]]; then
    say 'Measuring'
    measure_own
    keep_own
    exit 0
fi

export PENETRATION_BUILD="$folder/build"
mkdir -p "$PENETRATION_BUILD"
flags=(-Wall -Wextra -O3 -march=native -shared -fPIC)
# Bullet's headers are not free of the last.
bullet=(c++ -std=c++17 "${flags[@]}" -isystem /usr/include/bullet -Wno-maybe-uninitialized)

if [[ $size == --deforming ]]; then
    install_packages libbullet-dev
    "$environment/bin/pip" install drake==1.51.1 ipctk==1.6.1 matplotlib==3.11.2 mujoco==4.0.0 ||
        fail 'pip could not install the peers'
    "${bullet[@]}" c/bullet_soft.cpp -o "$PENETRATION_BUILD/bullet_soft.so" -lBulletSoftBody -lBulletDynamics \
        -lBulletCollision -lLinearMath || fail 'c/bullet_soft.cpp could not be built'
    scanned=()
    [[ -z "${2:-}" ]] || scanned=(--scan "$(absolute_path "$2")")
    say 'Measuring'
    mkdir -p "$folder"
    "$environment/bin/python" -m penetration_benchmark.deforming "${scanned[@]}" "$folder/deforming.csv" ||
        fail 'the measurement failed, see above'
    (cd "$root" && head_csv "$folder/deforming.csv" "$(drawn_seed "$folder/deforming.csv")" \
        "scripts/penetration.sh --deforming${2:+ ${2##*/}}")
    cp "$folder/deforming.csv" "$docs/"
    renew_pages
    say "Figures: $docs/deforming.csv"
    exit 0
fi

say 'Installing and building the peers'
install_packages libembree-dev libbullet-dev
"$environment/bin/pip" install "${peers[@]}" || fail "pip could not install ${peers[*]}"
# Embree 4 is inside embreex.
embree_4=("$environment"/lib/python3*/site-packages/embreex.libs/libembree4*)
cc -std=c99 "${flags[@]}" c/embree.c -o "$PENETRATION_BUILD/embree.so" -lembree3 -lm &&
    cc -std=c99 "${flags[@]}" -DEMBREE_4 c/embree.c -o "$PENETRATION_BUILD/embree4.so" "${embree_4[0]}" -lm \
        -Wl,-rpath,"${embree_4[0]%/*}" &&
    c++ -std=c++17 "${flags[@]}" c/shortest_path.cpp -o "$PENETRATION_BUILD/shortest_path.so" -lembree3 &&
    "${bullet[@]}" c/bullet.cpp -o "$PENETRATION_BUILD/bullet.so" -lBulletDynamics -lBulletCollision \
        -lLinearMath || fail 'the peers behind c/penetration.h could not be built'

say 'Measuring'
if [[ $size == --solvers ]]; then
    "$environment/bin/python" -m penetration_benchmark.solvers "$folder/solvers.csv" ||
        fail 'the measurement failed, see above'
    (cd "$root" && head_csv "$folder/solvers.csv" "$(drawn_seed "$folder/solvers.csv")" 'scripts/penetration.sh --solvers')
    cp "$folder/solvers.csv" "$docs/"
    renew_pages
    say "Figures: $docs/solvers.csv"
    exit 0
fi
if [[ $size == --quick ]]; then
    run "$folder/quick" --share 0.1
    say "Figures: $folder/quick"
    exit 0
fi
run "$folder/full" --tasks detect,measure,intersecting,simulate,self
# Ten thousand poses to part, and a tenth of them for those that would take one more hour.
run "$folder/free" --tasks free --share 53 \
    --libraries raycontact,raycontact-paper,raycontact-no-escape,embree,trimesh,fcl,coal,coal-patches,bullet
run "$folder/free-slow" --tasks free --share 5.3 --libraries mujoco,drake
measure_own
{ cat "$folder/free/free.csv" && tail --lines=+2 "$folder/free-slow/free.csv"; } >"$folder/full/free.csv"
head_all "$folder/full" scripts/penetration.sh --full
# Only now, since a commit whose files have changed is marked so in the heads.
cp "$folder/full"/*.csv "$docs/"
keep_own
renew_pages
say "Figures and charts: $docs"
