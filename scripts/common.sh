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

cd "$root"
