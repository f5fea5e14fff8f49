#!/usr/bin/env bash
# Makes the Debian packages, unpacks them into a folder and runs the program there.
#   debian.sh BUILD WORK LIBDIR        environment: CPACK
set -euo pipefail
build=$1 work=$2 lib=$3

if ! command -v dpkg-shlibdeps >/dev/null; then
  [ "${CI:-}" != true ] || { echo "dpkg-shlibdeps is missing (package dpkg-dev)" >&2; exit 1; }
  echo "skipped: dpkg-shlibdeps is missing (package dpkg-dev)"
  exit 77
fi

fail() {
  echo "$*" >&2
  exit 1
}

depends() { # PACKAGE PART: its dependencies name PART
  dpkg-deb -f "$work/$1"_*.deb Depends | grep -q -- "$2" || fail "$1 does not depend on $2"
}

rm -rf "$work"
mkdir -p "$work/root"
(cd "$build" && "$CPACK" -G DEB -B "$work" >"$work/log" 2>&1) || { cat "$work/log"; exit 1; }
for package in "$work"/*.deb; do
  dpkg-deb -f "$package" Package Depends
  dpkg-deb -x "$package" "$work/root"
done
depends libstiction0 libode
depends libstiction-dev "libstiction0 (= "
depends stiction libpopt0
if dpkg-deb -f "$work"/stiction_*.deb Depends | grep -E 'libav|libsdl'; then
  fail "stiction depends on what is stiction-video's and stiction-view's part"
fi
for part in video:libavcodec view:libsdl2; do
  [ ! -f "$work/stiction-${part%:*}"_*.deb ] || depends "stiction-${part%:*}" "${part#*:}"
done

"$work/root/usr/bin/stiction" --version
[ -f "$work/root/usr/$lib/libstiction.so.0" ] || fail "no shared library"
zcat "$work/root/usr/share/man/man1/stiction.1.gz" | grep -q '^\.TH STICTION' || fail "no man page"
# There is no mail address and no upload to Debian; CPack adds calls of ldconfig; the build that is tested here need
# not have been configured for /usr.
if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error,warning --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog \
    --suppress-tags initial-upload-closes-no-bugs,maintscript-calls-ldconfig,pkg-config-unavailable-for-cross-compilation "$work"/*.deb
fi
