#!/usr/bin/env bash
# Installs the Debian packages that are missing and checks the Rust toolchain.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

packages=(
    build-essential # C and C++ compilers, and the linker that cargo calls
    bsdutils        # lends a terminal to programs that colour one
    cmake           # 3.25 or newer
    ninja-build     # the generator of the presets
    pkg-config      # finds both builds of Bullet, and the installed package
    dpkg-dev        # makes the Debian packages
    python3-venv    # for the Conan client and the Python package, with parts from PyPI
    libbullet-dev   # Bullet, float and double
    python3-vtk9    # draws the demo's picture
    doxygen         # the manual
    libtbb-dev      # threads of a host, lent to the library
    libopenmpi-dev  # bodies over several processes, which openmpi-bin starts
    openmpi-bin
    libtrilinos-zoltan-dev # which process is to have which body
    valgrind        # counts instructions
    xvfb            # gives VTK something to draw on where there is no screen
    xauth           # xvfb-run needs it
)

usage() {
    cat <<END
usage: scripts/setup.sh [--help]

Installs what is missing of these Debian packages (through apt-get, with sudo when not root):
  ${packages[*]}
and checks that cargo, rustfmt and clippy are there. Installs nothing when nothing is missing.
Exit status: 0 when all is there, 1 when something cannot be had, 2 for a wrong command line.
END
}

case "${1:-}" in
    '') ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

for tool in cargo 'cargo fmt' 'cargo clippy'; do
    $tool --version >/dev/null 2>&1 || fail "'$tool' is missing. Install a Rust toolchain with rustfmt and clippy \
(https://rustup.rs; then 'rustup component add rustfmt clippy') and put cargo on the PATH."
done

install_packages "${packages[@]}"
