#!/usr/bin/env bash
# Makes what is released for this machine's kind of system, into target/packages:
#
#   meshwright-VERSION-TARGET.tar.gz   the program, manual pages, completions, licences; named as cargo binstall looks for it
#   meshwright_VERSION_ARCH.deb        the same for Debian, where dpkg-deb is there
#   meshwright-VERSION-*.whl           the Python module, where Python is there
#   SHA256SUMS
#
#     tools/package.sh [--profile PROFILE]      PROFILE is `release`, or `dev` to try the script
set -euo pipefail
cd "$(dirname "$0")/.."

profile=release
if [ "${1:-}" = --profile ]; then profile=$2; fi
folder=$profile
if [ "$profile" = dev ]; then folder=debug; fi

version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
target=$(rustc -vV | sed -n 's/^host: //p')
out=$PWD/target/packages
rm -rf "$out"
mkdir -p "$out"
# The same commit gives the same bytes.
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || echo 0)}
date="@$SOURCE_DATE_EPOCH"

echo "== licences are those of the crates"
python3 tools/licenses.py --check

echo "== program"
cargo build --locked --profile "$profile" --bin meshwright
cargo run --locked --quiet --example man_pages -- target/packages/documents

name=meshwright-$version-$target
stage=$out/$name
mkdir -p "$stage"
cp "target/$folder/meshwright" LICENSE-MIT LICENSE-APACHE README.md CHANGELOG.md "$stage"
cp src/cli/licenses.txt "$stage/LICENSES-OF-OTHERS.txt"
cp -r "$out/documents/man" "$out/documents/completions" "$stage"
tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="$date" -C "$out" -cf - "$name" | gzip -n -9 >"$out/$name.tar.gz"

if command -v dpkg-deb >/dev/null; then
    echo "== Debian package"
    arch=$(dpkg --print-architecture)
    root=$out/deb
    install -Dm755 "target/$folder/meshwright" "$root/usr/bin/meshwright"
    for page in "$out"/documents/man/*.1; do
        install -Dm644 "$page" "$root/usr/share/man/man1/$(basename "$page")"
        gzip -n -9 "$root/usr/share/man/man1/$(basename "$page")"
    done
    install -Dm644 "$out/documents/completions/meshwright.bash" "$root/usr/share/bash-completion/completions/meshwright"
    install -Dm644 "$out/documents/completions/_meshwright" "$root/usr/share/zsh/vendor-completions/_meshwright"
    install -Dm644 "$out/documents/completions/meshwright.fish" "$root/usr/share/fish/vendor_completions.d/meshwright.fish"
    cat LICENSE-MIT LICENSE-APACHE src/cli/licenses.txt >"$out/copyright"
    install -Dm644 "$out/copyright" "$root/usr/share/doc/meshwright/copyright"
    gzip -n -9 <CHANGELOG.md >"$out/changelog.gz"
    install -Dm644 "$out/changelog.gz" "$root/usr/share/doc/meshwright/changelog.gz"
    # The program needs the C library that it is linked with, or a later one.
    libc=$(objdump -T "target/$folder/meshwright" 2>/dev/null | grep -o 'GLIBC_[0-9.]*' | sort -Vu | tail -1 | cut -d_ -f2 || true)
    mkdir -p "$root/DEBIAN"
    cat >"$root/DEBIAN/control" <<CONTROL
Package: meshwright
Version: $version-1
Architecture: $arch
Maintainer: The meshwright developers <meshwright@localhost>
Section: graphics
Priority: optional
Depends: libc6 (>= ${libc:-2.31}), libgcc-s1
Recommends: mesa-vulkan-drivers
Installed-Size: $(du -sk "$root/usr" | cut -f1)
Description: repairs triangle meshes and does solid modelling on them
 Makes one closed solid of meshes as they really are: open, cracked,
 self-intersecting, flipped, doubled. Unites, intersects and subtracts them,
 opens and closes them morphologically, and measures distances.
CONTROL
    find "$root" -exec touch -h -d "$date" {} +
    dpkg-deb --root-owner-group --build "$root" "$out/meshwright_${version}-1_$arch.deb" >/dev/null
    rm -r "$root" "$out/copyright" "$out/changelog.gz"
fi

if command -v python3 >/dev/null; then
    echo "== wheel"
    venv=target/maturin
    [ -x "$venv/bin/maturin" ] || { python3 -m venv "$venv" && "$venv/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.9,<2'; }
    wheel=wheel
    if [ "$profile" = dev ]; then wheel=dev; fi
    "$venv/bin/maturin" build --quiet --locked --profile "$wheel" --manifest-path python/Cargo.toml --out "$out"
fi

rm -r "$out/documents" "$stage"
(cd "$out" && sha256sum -- * >SHA256SUMS && cat SHA256SUMS)
