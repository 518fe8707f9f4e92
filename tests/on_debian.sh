#!/usr/bin/env bash
# Builds everything and runs the tests in a bare root of Debian 12 or 13: tests/on_debian.sh 13 [-R REGEX ...]
# Arguments go to ctest. Needs root, for debootstrap and chroot. The root is kept, with what is installed and built in
# it, in $TREBSWEEP_ROOT or else in /var/tmp/trebsweep-debian-13.
set -euo pipefail
cd "$(dirname "$0")/.."
case ${1:-} in
  12) suite=bookworm ;;
  13) suite=trixie ;;
  *) echo "tests/on_debian.sh: release = ${1:-}: must be 12 or 13" >&2; exit 2 ;;
esac
[[ $EUID == 0 ]] || { echo "tests/on_debian.sh: must be run as root, for debootstrap and chroot" >&2; exit 2; }
root=${TREBSWEEP_ROOT:-/var/tmp/trebsweep-debian-$1}
shift
if [[ ! -e $root/etc/debian_version ]]; then
  jobs/install.sh debootstrap
  debootstrap --variant=minbase $suite "$root"
fi
mkdir -p "$root/src"
git ls-files -z | tar --null --files-from=- -cf - | tar -xf - -C "$root/src"
# The mounts end with the command.
unshare --mount bash -c 'for directory in proc sys dev; do mount --rbind /$directory "$0/$directory"; done
                         exec chroot "$0" /src/tests/run.sh "$@"' "$root" "$@"
