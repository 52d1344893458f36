#!/usr/bin/env bash
# Installs the peers, builds in release and measures raycontact beside them, all in one run.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

usage() {
    cat <<END
usage: scripts/bench.sh [quick|full|docs] [options of the measuring program]

quick (default): every method on the ordinary workloads, within three minutes after the build.
full: also up to 409 600 triangles a body and up to 1000 bodies.
docs: measures nothing; takes the last measurement over into docs/performance.md and docs/performance/.
Writes out/bench/detect.csv and charts beside it, and prints how many times as long as raycontact each peer takes.
Further options go to the measuring program; with --help it lists them.
Exit status: 0 when measured, 1 when something failed, 2 for a wrong command line.
END
}

size=()
measures=true
case "${1:-quick}" in
    quick) ;;
    full) size=(--full) ;;
    docs) measures=false ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac
(($# == 0)) || shift

packages=(
    libembree-dev # Embree 3.13
    libfcl-dev    # FCL 0.7
    libbullet-dev # Bullet 3.24
)

install_peers() {
    local missing=() as_root=() package
    for package in "${packages[@]}"; do
        [[ "$(dpkg-query --show --showformat='${Status}' "$package" 2>/dev/null)" == 'install ok installed' ]] ||
            missing+=("$package")
    done
    ((${#missing[@]})) || return 0
    if ((EUID != 0)); then
        command -v sudo >/dev/null || fail "missing packages: ${missing[*]}. There is no sudo: run as root: \
apt-get install ${missing[*]}"
        as_root=(sudo)
    fi
    say "Installing ${missing[*]}"
    "${as_root[@]}" apt-get --quiet update >&2 || fail "'apt-get update' failed: is there a network?"
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get --quiet --yes -o DPkg::Lock::Timeout=300 install \
        --no-install-recommends "${missing[@]}" >&2 || fail "apt-get could not install ${missing[*]}"
}

# raycontact as its users build it, the peers for this very processor: two builds, so two folders.
target="$(absolute_path "${CARGO_TARGET_DIR:-$root/target}")/bench"
build() {
    cargo build --release --locked --manifest-path benches/Cargo.toml "$@" >&2 || fail 'the build failed, see above'
}

scripts/setup.sh
install_peers
say 'Building (release)'
RUSTFLAGS='' build --package raycontact-bench --target-dir "$target/portable"
bench="$target/portable/release/bench"

if [[ $measures == false ]]; then
    [[ -r out/bench/detect.csv ]] || fail "there is no out/bench/detect.csv yet: run 'scripts/bench.sh full' first"
    mkdir -p docs/performance
    cp out/bench/detect.csv docs/performance/
    "$bench" --out docs/performance --document docs/performance.md
    say "Renewed: $root/docs/performance.md"
    exit 0
fi

RUSTFLAGS='-C target-cpu=native' build --package raycontact-bench-peers --target-dir "$target/native"
say 'Measuring'
"$bench" "${size[@]}" --out out/bench --peers "$target/native/release/libraycontact_bench_peers.so" "$@"
say "Times and charts: $root/out/bench"
