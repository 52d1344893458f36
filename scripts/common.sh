# shellcheck shell=bash
# Shared by the scripts beside it: sourced, not run. Leaves the shell in the root of the repository.
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
caller_dir="$PWD"

# Colours only for a person, and only when wanted.
if [[ -t 2 && -z "${NO_COLOR:-}" && "${TERM:-dumb}" != dumb ]]; then
    bold=$'\e[1m' red=$'\e[31m' plain=$'\e[0m'
else
    bold='' red='' plain=''
fi

say() { printf '%s==> %s%s\n' "$bold" "$*" "$plain" >&2; }

# fail <message> [exit status]
fail() {
    printf '%s%s: %s%s\n' "$red" "$(basename "$0")" "$1" "$plain" >&2
    exit "${2:-1}"
}

# Paths on the command line are the caller's, not the repository's.
absolute_path() {
    case "$1" in
        /*) printf '%s\n' "$1" ;;
        *) printf '%s/%s\n' "$caller_dir" "$1" ;;
    esac
}

# head_csv <file> <seed> <command>: says in the first line of a file of figures where they come from.
head_csv() {
    local commit
    commit="$(git describe --always --dirty --exclude '*')"
    sed -i "1i # date $(date +%F), commit $commit, seed $2, command $3" "$1"
}

# install_packages <Debian package>...: those that are missing.
install_packages() {
    command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
        fail "this is not a Debian-like system; install the equivalents of: $*"
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
    # Another installation may hold the lock for a while.
    local apt_get=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get --quiet --yes -o DPkg::Lock::Timeout=300)
    "${apt_get[@]}" update >&2 ||
        fail "'apt-get update' failed: is there a network, and are the package sources right?"
    "${apt_get[@]}" install --no-install-recommends "${missing[@]}" >&2 ||
        fail "apt-get could not install ${missing[*]}"
}

cd "$root"

# make_environment <folder>: a virtual environment of Python, where there is none.
make_environment() {
    [[ ! -x "$1/bin/pip" ]] || return 0
    python3 -c 'import ensurepip' 2>/dev/null || install_packages python3-venv
    python3 -m venv --clear "$1" || fail "python3 cannot make a virtual environment in $1"
}

# side_by_side <function>: calls it with the arguments of each line of the input, as many at a time as there are processors.
# Ends with 1 at the first call that fails.
side_by_side() {
    local running=0 arguments
    while read -ra arguments; do
        if ((running == $(nproc))); then
            wait -n || return 1
            running=$((running - 1))
        fi
        "$1" "${arguments[@]}" &
        running=$((running + 1))
    done
    for ((; running; --running)); do
        wait -n || return 1
    done
}
