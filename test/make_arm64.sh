#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# make_arm64.sh FOLDER: Debian's Python for ARM64 in FOLDER/root, the packages that a simulation
# needs in FOLDER/packages. The system's own packages stay as they are; run it by qemu-user-static.
set -eu
folder=$1
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
here=$(cd "$(dirname "$0")/.." && pwd)
needed='attrs jsonschema jsonschema-specifications lz4 mcap numpy PyYAML referencing rpds-py scipy tqdm
    typing_extensions zstandard'

fail() {
    echo "ARM64: $*" >&2
    exit 1
}

for tool in apt-get dpkg-deb; do
    command -v $tool > /dev/null || fail "needs $tool, of Debian or Ubuntu"
done
command -v qemu-aarch64-static > /dev/null || fail 'needs the package qemu-user-static'
made=$(cat "$here/requirements/run.txt" "$0")
[ -e "$folder/made" ] && [ "$(cat "$folder/made")" = "$made" ] && exit 0

state=$folder/apt
mkdir -p "$state/lists/partial" "$state/cache/archives/partial"
touch "$state/status"
for setting in 'APT::Architecture "arm64"' 'APT::Architectures "arm64"' \
    "Dir::State \"$state\"" "Dir::State::status \"$state/status\"" "Dir::Cache \"$state/cache\""; do
    echo "$setting;"
done > "$state/settings"
export APT_CONFIG="$state/settings"
apt-get -qq update || fail 'apt-get found no lists for arm64'
apt-get -qq install --no-install-recommends --download-only -y python3 libstdc++6 \
    > /dev/null || fail 'apt-get found no Python for arm64'
unset APT_CONFIG
rm -rf "$folder/root" "$folder/packages"
mkdir "$folder/root"
for package in "$state"/cache/archives/*.deb; do
    dpkg-deb --extract "$package" "$folder/root"
done
version=$(ls "$folder/root/usr/bin" | sed -n 's/^python\(3\.[0-9][0-9]*\)$/\1/p')
pattern=$(echo $needed | tr ' ' '|')
grep -E "^($pattern)==" "$here/requirements/run.txt" > "$folder/pins.txt"
"$here/.venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps \
    --only-binary=:all: --implementation cp --python-version "$version" \
    --abi "cp$(echo "$version" | tr -d .)" --abi abi3 --abi none \
    --platform manylinux_2_28_aarch64 --platform manylinux_2_27_aarch64 \
    --platform manylinux_2_17_aarch64 --platform manylinux2014_aarch64 \
    --target "$folder/packages" -r "$folder/pins.txt" || fail 'pip found no wheels for arm64'
echo "$made" > "$folder/made"
