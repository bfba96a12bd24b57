#!/bin/sh
# Installs the packages of the given roles that are missing, and does nothing when none is:
# install-debian-packages.sh ROLE...
set -eu

packages=$("$(dirname "$0")/debian-packages.sh" "$@")
command -v dpkg-query >/dev/null || {
    echo "This is not Debian. Install the equivalents of:" $packages >&2
    exit 1
}

# dpkg-query fails for names it has never heard of, which is one way of being missing.
installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $packages 2>/dev/null | sed -n 's/^installed //p') || true
missing=$(printf '%s\n' $packages | grep -vxF "$installed") || true
[ -n "$missing" ] || exit 0

if [ "$(id -u)" = 0 ]; then
    as_root=
elif command -v sudo >/dev/null; then
    as_root=sudo
else
    echo "Missing packages, and neither root nor sudo to install them. As root:" >&2
    echo "  apt-get install --no-install-recommends" $missing >&2
    exit 1
fi

echo "Installing Debian packages:" $missing
$as_root apt-get -o DPkg::Lock::Timeout=300 -qq update
$as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 -qq -y --no-install-recommends install $missing >/dev/null
