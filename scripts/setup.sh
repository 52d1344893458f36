#!/usr/bin/env bash
# Installs the Debian packages that are missing and checks the Rust toolchain.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

demo_packages=(
    build-essential # C and C++ compilers, and the linker that cargo calls
    cmake           # 3.25 or newer
    ninja-build     # the generator of the presets
    pkg-config      # finds both builds of Bullet, and the installed package
    libbullet-dev   # Bullet, float and double
    python3-vtk9    # draws the demo's picture
    xvfb            # gives VTK something to draw on where there is no screen
    xauth           # xvfb-run needs it
)
other_packages=(
    bsdutils        # lends a terminal to programs that colour one
    dpkg-dev        # makes the Debian packages
    file            # tells CPack which files are programs and libraries
    python3-venv    # for the Conan client and the Python package, with parts from PyPI
    python3-pil     # makes a moving picture of pictures
    doxygen         # the manual
    libtbb-dev      # threads of a host, lent to the library
    libopenmpi-dev  # bodies over several processes, which openmpi-bin starts
    openmpi-bin
    libtrilinos-zoltan-dev # which process is to have which body
    libsimbody-dev  # Simbody, for the example with it
    valgrind        # counts instructions
)

usage() {
    cat <<END
usage: scripts/setup.sh [demo]

Installs what is missing of the Debian packages that the project's scripts and tests use (through apt-get, with sudo when
not root) and checks that cargo, rustfmt and clippy are there. Installs nothing when nothing is missing.
demo: what scripts/demo.sh needs alone, which is cargo and
  ${demo_packages[*]}
All others:
  ${other_packages[*]}
Exit status: 0 when all is there, 1 when something cannot be had, 2 for a wrong command line.
END
}

packages=("${demo_packages[@]}" "${other_packages[@]}")
checks_code=true
case "${1:-}" in
    '') ;;
    demo) packages=("${demo_packages[@]}") checks_code=false ;;
    -h | --help) usage && exit 0 ;;
    *) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac

for tool in cargo 'cargo fmt' 'cargo clippy'; do
    [[ $tool == cargo || $checks_code == true ]] || continue
    $tool --version >/dev/null 2>&1 || fail "'$tool' is missing. Install a Rust toolchain with rustfmt and clippy \
(https://rustup.rs; then 'rustup component add rustfmt clippy') and put cargo on the PATH."
done

install_packages "${packages[@]}"
