#!/usr/bin/env bash
# Runs a script of the project in a bare Debian 12, so that nothing installed here hides a package that it forgot.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

folder="$root/target/bare_debian"
mirror=http://deb.debian.org/debian

usage() {
    cat <<END
usage: scripts/bare_debian.sh [command]...

Makes a bare Debian 12 in target/bare_debian (debootstrap), adds git, certificates, this machine's Rust toolchain and a
fresh clone of the last commit, and runs the commands there, each in the clone; scripts/demo.sh where none is given. Prints
how long each took, downloads included. Needs root; what an earlier run made is removed first.
For instance: scripts/bare_debian.sh scripts/demo.sh scripts/python.sh 'cmake --workflow --preset deb'
Exit status: 0 when all commands ended with 0, 1 at the first that did not, 2 for a wrong command line.
END
}

case "${1:-}" in
    -h | --help) usage && exit 0 ;;
    -*) usage >&2 && fail "unknown argument '$1'" 2 ;;
esac
commands=("${@:-scripts/demo.sh}")
((EUID == 0)) || fail 'only root can make a system and change into it'

install_packages debootstrap
say "Making a bare Debian 12 in $folder"
rm -rf "$folder"
mkdir -p "$folder"
debootstrap --variant=minbase --include=ca-certificates,git bookworm "$folder" "$mirror" >&2 ||
    fail 'debootstrap failed, see above'
mkdir -p "$folder/opt/rust"
cp -r "$(rustc --print sysroot)/." "$folder/opt/rust"
cp -L /etc/resolv.conf "$folder/etc"
# Certificates that somebody has this machine trust.
find /usr/local/share/ca-certificates -name '*.crt' -exec cp -t "$folder/usr/local/share/ca-certificates" {} +
git clone --quiet "$root" "$folder/root/raycontact"

# inside <command>: in the clone. Mounts last as long as the command.
inside() {
    unshare --mount --pid --fork bash -c '
        set -e
        mount --bind /dev "$0/dev"
        mount -t proc proc "$0/proc"
        exec chroot "$0" env -i HOME=/root LANG=C.UTF-8 PATH=/opt/rust/bin:/usr/sbin:/usr/bin:/sbin:/bin \
            bash -c "cd /root/raycontact && $1"' "$folder" "$1"
}

inside update-ca-certificates >&2
times=()
for command in "${commands[@]}"; do
    say "In the bare system: $command"
    start=$SECONDS
    inside "$command" || fail "'$command' failed in the bare system, see above"
    times+=("$(printf '%4d s  %s' $((SECONDS - start)) "$command")")
done
say 'All commands ended well'
printf '%s\n' "${times[@]}"
