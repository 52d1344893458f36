# shellcheck shell=bash
# Installs packages, and builds the measuring program and its peers: sourced after common.sh, not run.

peer_packages=(
    libembree-dev # Embree 3.13
    libfcl-dev    # FCL 0.7
    libbullet-dev # Bullet 3.24
)

# install_packages <Debian package>...
install_packages() {
    local missing=() as_root=() package
    for package in "$@"; do
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
build_package() {
    cargo build --release --locked --manifest-path benches/Cargo.toml "$@" >&2 || fail 'the build failed, see above'
}

# Prints where the measuring program is.
build_bench() {
    install_packages "${peer_packages[@]}"
    say 'Building (release)'
    RUSTFLAGS='' build_package --package raycontact-bench --target-dir "$target/portable"
    printf '%s\n' "$target/portable/release/bench"
}

# Prints where the shared library with the peers is.
build_peers() {
    RUSTFLAGS='-C target-cpu=native' build_package --package raycontact-bench-peers --target-dir "$target/native"
    printf '%s\n' "$target/native/release/libraycontact_bench_peers.so"
}
