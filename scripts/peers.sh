# shellcheck shell=bash
# Builds the measuring program and its peers: sourced after common.sh, not run.

peer_packages=(
    libembree-dev # Embree 3.13
    libfcl-dev    # FCL 0.7
    libbullet-dev # Bullet 3.24
)

# read_size <quick, full or docs>: sets `size`, options of the measuring program, and whether it `measures`.
read_size() {
    size=() measures=true
    case "$1" in
        quick) ;;
        full) size=(--full) ;;
        docs) measures=false ;;
        -h | --help) usage && exit 0 ;;
        *) usage >&2 && fail "unknown argument '$1'" 2 ;;
    esac
}

# raycontact as its users build it, from Rust and as the shared library for C; the peers for this very processor. Three
# builds, so three folders.
target="$(absolute_path "${CARGO_TARGET_DIR:-$root/target}")/bench"
build_package() {
    cargo build --release --locked --manifest-path evaluation/bench/Cargo.toml "$@" >&2 || fail 'the build failed, see above'
}

# Prints where the measuring program is.
build_bench() {
    install_packages "${peer_packages[@]}"
    say 'Building (release)'
    RUSTFLAGS='' build_package --package raycontact-bench --target-dir "$target/portable"
    printf '%s\n' "$target/portable/release/bench"
}

# Prints where the shared library for C is.
build_library() {
    cargo build --release --locked --lib >&2 || fail 'the build failed, see above'
    printf '%s\n' "$(absolute_path "${CARGO_TARGET_DIR:-$root/target}")/release/libraycontact.so"
}

# Prints where the shared library with the peers is. Debian has no Embree 4: it is taken out of PyPI's embreex.
build_peers() {
    local environment="$target/embree" embree_4
    make_environment "$environment"
    "$environment/bin/pip" install --quiet --disable-pip-version-check --no-deps embreex==4.4.0.post1 >&2 ||
        fail 'pip could not install embreex, in which Embree 4 is'
    embree_4="$(echo "$environment"/lib/python3*/site-packages/embreex.libs/libembree4*)"
    EMBREE_4="$embree_4" RUSTFLAGS='-C target-cpu=native' \
        build_package --package raycontact-bench-peers --target-dir "$target/native"
    printf '%s\n' "$target/native/release/libraycontact_bench_peers.so"
}

# start_measuring <last CSV file> <its folder in docs> [quick, full or docs]: builds `bench`; then either what
# `libraries` names, with `size` set, or, for docs, copies the file there.
start_measuring() {
    read_size "${3:-quick}"
    scripts/setup.sh
    bench="$(build_bench)"
    if [[ $measures == true ]]; then
        library="$(build_library)"
        peers="$(build_peers)"
        libraries=(--library "$library" --peers "$peers")
        say 'Measuring'
        return
    fi
    [[ -r "$1" ]] || fail "there is no $1 yet: run 'scripts/$(basename "$0") full' first"
    mkdir -p "$2"
    cp "$1" "$2/"
}
